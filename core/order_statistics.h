// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

/// Single values of a list by their rank, without sorting it.
namespace dubsar {

/// The standard deviation of normally distributed values about 0 as a multiple of the median of their
/// absolute values: 1 / Φ⁻¹(3/4).
inline constexpr double kSigmaOfMedian = 1.4826;

/// The value of rank `k`, from 0 for the least; there must be that many. Puts them into another order.
template <class Values>
[[nodiscard]] auto value_at_rank(Values& values, std::size_t k) {
  const auto at = std::begin(values) + static_cast<std::ptrdiff_t>(k);
  std::nth_element(std::begin(values), at, std::end(values));
  return *at;
}

/// The middle value, the upper of two; there must be one.
template <class Value>
[[nodiscard]] Value median_of(std::vector<Value> values) {
  return value_at_rank(values, values.size() / 2);
}

}  // namespace dubsar
