// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>

namespace dubsar {

/// "scan 3", "scans 3 and 5", "scans 0, 3 and 5": for people. `ids` in the order in which they are to stand.
template <class Ids>
[[nodiscard]] std::string listed(const Ids& ids) {
  std::string text = ids.size() == 1 ? "scan " : "scans ";
  std::size_t left = ids.size();
  for (const int id : ids) {
    text += std::to_string(id);
    --left;
    text += left > 1 ? ", " : left == 1 ? " and " : "";
  }
  return text;
}

}  // namespace dubsar
