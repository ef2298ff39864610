// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planning/clusters.h"

namespace dubsar {

namespace {

/// Grid neighbours farther apart than this are rims of two holes, or of the object itself.
constexpr double kGridReachMm = 5.0;

/// The side of the tablet that a place lies on: that of the hull over it. Its own normal would not do: the
/// wall of a wedge on the obverse looks to the right or to the top edge.
Face side_at(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& normal, const ModelSurface& surface) {
  const SurfacePatch* nearest = nullptr;
  double least_mm2 = std::numeric_limits<double>::infinity();
  for (const auto* patches : {&surface.seen, &surface.unseen}) {
    for (const SurfacePatch& patch : *patches) {
      if (const double d = (patch.position_mm - position_mm).squaredNorm(); d < least_mm2) {
        least_mm2 = d;
        nearest = &patch;
      }
    }
  }
  return surface.faces.of(nearest != nullptr ? nearest->normal : normal);
}

RedRegion region_of(const RedTargets& red, std::span<const std::uint32_t> group,
                    const ModelSurface& surface) {
  RedRegion region;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::array<double, kFaceCount> by_face{};
  constexpr std::size_t kAsked = 16;  // of a large place these say as much
  const std::size_t stride = (group.size() + kAsked - 1) / kAsked;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const std::uint32_t i = group[k];
    const RedTarget& t = red.targets[i];
    region.area_mm2 += t.area_mm2;
    center += t.area_mm2 * t.position_mm;
    normal += t.area_mm2 * t.normal;
    if (k % stride == 0) {
      by_face[static_cast<std::size_t>(side_at(t.position_mm, t.normal, surface))] += t.area_mm2;
    }
  }
  // What most of it is says why.
  const std::uint32_t largest = *std::max_element(
      group.begin(), group.end(),
      [&](std::uint32_t a, std::uint32_t b) { return red.targets[a].area_mm2 < red.targets[b].area_mm2; });
  const RedTarget& main = red.targets[largest];
  region.center_mm = region.area_mm2 > 0 ? Eigen::Vector3d(center / region.area_mm2) : main.position_mm;
  region.normal = normal.norm() > 1e-9 ? normal.normalized() : main.normal;
  region.face = static_cast<Face>(std::max_element(by_face.begin(), by_face.end()) - by_face.begin());
  region.state = main.state;
  region.excuse = main.excuse;
  region.reason = main.reason;
  return region;
}

}  // namespace

std::vector<RedRegion> red_regions(const RedTargets& red, std::span<const PlacedScan> scans,
                                   const ModelSurface& surface) {
  double patch_mm = 0;
  for (const SurfacePatch& patch : surface.unseen) {
    patch_mm = std::max(patch_mm, std::sqrt(patch.area_mm2));
  }
  std::vector<RedRegion> regions;
  for (const auto& group :
       cluster_targets(red, scans, std::max(2.0 * red.cell_mm, 1.8 * patch_mm), kGridReachMm, true)) {
    regions.push_back(region_of(red, group, surface));
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const RedRegion& a, const RedRegion& b) { return a.area_mm2 > b.area_mm2; });
  return regions;
}

}  // namespace dubsar
