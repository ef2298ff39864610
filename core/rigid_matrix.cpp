// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rigid_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dubsar {

std::optional<RigidTransform> rigid_from_row_major(std::span<const double, 16> numbers) {
  constexpr double kExact = 1e-9;  // what an inverse or a product by others leaves of 0 and 1
  constexpr std::array<double, 4> kLastRow{0, 0, 0, 1};
  const bool last_row = std::ranges::equal(numbers.last<4>(), kLastRow, [](double is, double should_be) {
    return std::abs(is - should_be) <= kExact;  // false of what is not finite
  });
  std::array<double, 16> rows{};
  std::ranges::copy(numbers, rows.begin());
  const RigidTransform transform = RigidTransform::from_row_major(rows);
  return last_row && transform.is_rigid() ? std::optional(transform) : std::nullopt;
}

}  // namespace dubsar
