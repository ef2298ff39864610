// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/utf8.h"

namespace dubsar {

/// "a, b and 3 more", for people: whatever bytes the names are of.
[[nodiscard]] inline std::string file_list(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 20;
  std::string words;
  for (std::size_t k = 0; k < names.size() && k < kMost; ++k) {
    words += k == 0 ? "" : ", ";
    words += one_line(names[k]);
  }
  if (names.size() > kMost) {
    words.append(" and ").append(std::to_string(names.size() - kMost)).append(" more");
  }
  return words;
}

}  // namespace dubsar
