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

PlacedPrecision::PlacedPrecision(const RangeGrid& grid)
    : middle_mm_(middle_of(grid)),
      spacing_mm_(grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid)) {}

Status PlacedPrecision::check(const RigidTransform& model_from_scanner, const std::string& name) const {
  const double farthest_mm = (model_from_scanner * middle_mm_).cwiseAbs().maxCoeff();
  if (!std::isfinite(farthest_mm) || !(spacing_mm_ > 0) ||
      keeps_places(farthest_mm, kShortestEdge * spacing_mm_)) {
    return {};
  }
  return bad_input(name,
                   "its pose puts it " + fixed_text(farthest_mm / 1000, 0) +
                       " m from the origin, too far for its samples to keep their places to a small "
                       "part of their spacing",
                   "take the offset of a map or a room from all poses, or mend this one");
}

ScanPose PlacedPrecision::judged(ScanPose pose) const {
  if (pose.status != PoseStatus::kRegistered) {
    return pose;
  }
  if (const Status near = check(pose.model_from_scanner, pose.file); !near) {
    pose.status = PoseStatus::kFailed;
    pose.reason = near.error().what + "; " + near.error().mend;
  }
  return pose;
}

}  // namespace dubsar
