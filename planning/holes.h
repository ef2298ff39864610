// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dubsar {

/// A bit of well-sampled surface at which it ends.
struct Rim {
  Eigen::Vector3d position_mm{0, 0, 0};  ///< model frame
  Eigen::Vector3d normal{0, 0, 1};       ///< of the surface, out of the clay
  Eigen::Vector3d outward{1, 0, 0};      ///< along the surface, to where nothing is sampled; unit
  std::uint32_t part = 0;                ///< of the cover
  double reach_mm = 0;                   ///< of the cover there
};

/// A connected rim.
struct Hole {
  std::vector<std::uint32_t> rim;  ///< positions in rims()
  double width_mm = 0;             ///< greatest extent of the rim
  double area_mm2 = 0;             ///< of the rim's polygon, seen along the direction in which it is flattest
};

/// Rims that lie within the reach of one of them from each other, directly or by others, are one hole's.
[[nodiscard]] std::vector<Hole> holes_of(const std::vector<Rim>& rims);

}  // namespace dubsar
