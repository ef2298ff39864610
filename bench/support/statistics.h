// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <vector>

#include "core/order_statistics.h"

namespace dubsar::bench {

/// The value at rank q (n − 1), q in [0, 1]; 0 of no values.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0;
  }
  return value_at_rank(values, static_cast<std::size_t>(q * static_cast<double>(values.size() - 1)));
}

}  // namespace dubsar::bench
