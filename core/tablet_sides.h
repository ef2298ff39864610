// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "core/red_map.h"

namespace dubsar {

/// How a side is read, in the text's frame (x to the reader's right and y up on the obverse, z out of it).
struct SideAxes {
  Face face = Face::kObverse;
  Eigen::Vector3d normal{0, 0, 1};
  Eigen::Vector3d right{1, 0, 0};
  [[nodiscard]] Eigen::Vector3d up() const { return normal.cross(right); }
};

/// A tablet is turned over its lower edge: x stays the reader's right. Lines that run over the right edge go
/// on there; the left edge is read from the top down.
[[nodiscard]] inline const SideAxes& side_axes(Face face) {
  using V = Eigen::Vector3d;
  static const std::array<SideAxes, kFaceCount> kSides = {{{Face::kObverse, V(0, 0, 1), V(1, 0, 0)},
                                                           {Face::kReverse, V(0, 0, -1), V(1, 0, 0)},
                                                           {Face::kLeft, V(-1, 0, 0), V(0, -1, 0)},
                                                           {Face::kRight, V(1, 0, 0), V(0, 0, -1)},
                                                           {Face::kTop, V(0, 1, 0), V(1, 0, 0)},
                                                           {Face::kBottom, V(0, -1, 0), V(1, 0, 0)}}};
  return kSides[static_cast<std::size_t>(face)];
}

}  // namespace dubsar
