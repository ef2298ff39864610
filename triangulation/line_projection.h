// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include "triangulation/stitch_surface.h"

namespace dubsar {

/// The line through a sample on which it moves. To where it meets other scans, not to their nearest points:
/// of a rough sheet the nearest point is the one that errs the same way as p, and averaging with it takes
/// away next to nothing of the noise.
struct Line {
  Eigen::Vector3f p, n, u, v;

  Line(const Eigen::Vector3f& at, const Eigen::Vector3f& direction)
      : p(at), n(direction), u(direction.unitOrthogonal()), v(direction.cross(u)) {}
};

/// Where a line meets the triangles of a scan.
struct Projection {
  std::size_t sample = 0;           ///< a corner of the triangle
  Eigen::Vector3f normal{0, 0, 0};  ///< of that sample
  float along_mm = 0;               ///< from p along the line
  bool well_sampled = false;        ///< none of the corners is sparse
  std::uint8_t rim = 0;             ///< of the corner that is nearest to it
  float weight = 0;                 ///< interpolated; 0 where the line misses the other scan's triangles
  float reliability = 0;            ///< interpolated
  /// How far the surface lies from the flat triangle there if it bends as the normals at its corners say; out
  /// of the clay is positive.
  float bulge_mm = 0;
};

/// Steps from a cell of the scan's grid (row and column as they are guessed, cut off at its rim) towards the
/// line, then looks there and all around.
[[nodiscard]] Projection project(const Line& line, const StitchSurface& on, float at_row, float at_col);

}  // namespace dubsar
