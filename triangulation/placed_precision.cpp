// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/placed_precision.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/keeps_places.h"
#include "core/number_text.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;

/// Edges of a mesh may be shorter than the spacing of the scans that it is stitched of.
constexpr double kShortestEdge = 0.5;
/// What lies beyond in the scanner's frame is no sample that has neighbours.
constexpr float kStrayMm = 1e6F;

/// Of the valid samples, scanner frame; strays do not count.
Vector3d middle_of(const RangeGrid& grid) {
  struct Sum {
    Vector3d of = Vector3d::Zero();
    std::size_t count = 0;
  };
  const Sum all = parallel_reduce_ordered(
      grid.size(), 16384, Sum{},
      [&](std::size_t begin, std::size_t end) {
        Sum part;
        for (std::size_t i = begin; i < end; ++i) {
          if (grid.valid[i] != 0 && grid.point(i).allFinite() &&
              grid.point(i).cwiseAbs().maxCoeff() < kStrayMm) {
            part.of += grid.point(i).cast<double>();
            ++part.count;
          }
        }
        return part;
      },
      [](Sum& total, const Sum& part) {
        total.of += part.of;
        total.count += part.count;
      });
  return all.of / static_cast<double>(std::max<std::size_t>(all.count, 1));
}

}  // namespace

Status check_placed_precision(const PlacedScan& scan, const std::string& name) {
  const RangeGrid& grid = *scan.grid;
  const double farthest_mm = (scan.model_from_scanner * middle_of(grid)).cwiseAbs().maxCoeff();
  if (!std::isfinite(farthest_mm) || keeps_places(farthest_mm, 0)) {
    return {};
  }
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  if (!(spacing_mm > 0) || keeps_places(farthest_mm, kShortestEdge * spacing_mm)) {
    return {};
  }
  return bad_input(name,
                   "its pose puts it " + fixed_text(farthest_mm / 1000, 0) +
                       " m from the origin, too far for its samples to keep their places to a small "
                       "part of their spacing",
                   "take the offset of a map or a room from all poses, or mend this one");
}

}  // namespace dubsar
