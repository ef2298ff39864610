// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace dubsar::bench {

/// The value at rank q (n − 1), q in [0, 1]; 0 of no values.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0;
  }
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

}  // namespace dubsar::bench
