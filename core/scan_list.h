// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

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

/// The same with three and more in a row as "scans 0 to 4, 7 and 9". `ids` ascending.
template <class Ids>
[[nodiscard]] std::string listed_in_runs(const Ids& ids) {
  std::vector<std::string> runs;
  for (auto at = ids.begin(); at != ids.end();) {
    auto end = std::next(at);
    int last = *at;
    while (end != ids.end() && *end == last + 1) {
      last = *end++;
    }
    if (last - *at >= 2) {
      runs.push_back(std::to_string(*at) + " to " + std::to_string(last));
    } else {
      std::transform(at, end, std::back_inserter(runs), [](int id) { return std::to_string(id); });
    }
    at = end;
  }
  std::string text = ids.size() == 1 ? "scan " : "scans ";
  for (std::size_t k = 0; k < runs.size(); ++k) {
    text += (k == 0 ? "" : k + 1 < runs.size() ? ", " : " and ") + runs[k];
  }
  return text;
}

}  // namespace dubsar
