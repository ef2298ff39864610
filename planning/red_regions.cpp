// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "planning/clusters.h"

namespace dubsar {

namespace {

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

/// The side that a target faces: a patch of what nobody has seen knows it by itself.
Face side_of(const RedTarget& t, const ModelSurface& surface) {
  return t.unseen && !t.rim ? surface.faces.of(t.normal) : side_at(t.position_mm, t.normal, surface);
}

/// A large place that goes round edges of the tablet, in parts that face one side each: who scans goes by
/// sides. A scrap of a side goes with the largest part.
std::vector<std::vector<std::uint32_t>> parts_by_side(const RedTargets& red, std::vector<std::uint32_t> group,
                                                      const ModelSurface& surface) {
  constexpr double kLargeMm2 = 20.0;
  constexpr double kLeastPartMm2 = 10.0;
  constexpr double kLeastShare = 0.1;
  double area_mm2 = 0;
  for (const std::uint32_t i : group) {
    area_mm2 += red.targets[i].area_mm2;
  }
  if (area_mm2 < kLargeMm2) {
    return {std::move(group)};
  }
  std::vector<std::size_t> side(group.size());
  parallel_for_each_index(
      group.size(),
      [&](std::size_t k) { side[k] = static_cast<std::size_t>(side_of(red.targets[group[k]], surface)); },
      64);
  std::array<double, kFaceCount> by_side{};
  for (std::size_t k = 0; k < group.size(); ++k) {
    by_side[side[k]] += red.targets[group[k]].area_mm2;
  }
  const auto largest =
      static_cast<std::size_t>(std::max_element(by_side.begin(), by_side.end()) - by_side.begin());
  std::array<std::vector<std::uint32_t>, kFaceCount> parts;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const bool scrap = by_side[side[k]] < std::max(kLeastPartMm2, kLeastShare * area_mm2);
    parts[scrap ? largest : side[k]].push_back(group[k]);
  }
  std::vector<std::vector<std::uint32_t>> out;
  for (auto& part : parts) {
    if (!part.empty()) {
      out.push_back(std::move(part));
    }
  }
  return out;
}

/// Why a red place stays red, where no view will clear most of it.
std::string why_red(const RedTargets& red, std::span<const std::uint32_t> group, double area_mm2) {
  double silent_mm2 = 0;
  const RedTarget* largest = nullptr;
  for (const std::uint32_t i : group) {
    const RedTarget& t = red.targets[i];
    if (!t.reason.empty()) {
      silent_mm2 += t.area_mm2;
      largest = largest == nullptr || t.area_mm2 > largest->area_mm2 ? &t : largest;
    }
  }
  return largest != nullptr && silent_mm2 >= 0.5 * area_mm2 ? largest->reason : std::string();
}

RedRegion region_of(const RedTargets& red, std::span<const std::uint32_t> group,
                    const ModelSurface& surface) {
  RedRegion region;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::array<double, kFaceCount> by_face{};
  for (const std::uint32_t i : group) {
    const RedTarget& t = red.targets[i];
    region.area_mm2 += t.area_mm2;
    center += t.area_mm2 * t.position_mm;
    normal += t.area_mm2 * t.normal;
  }
  // Patches answer at once; of many samples these say as much.
  constexpr std::size_t kAsked = 64;
  const std::size_t stride = (group.size() + kAsked - 1) / kAsked;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const RedTarget& t = red.targets[group[k]];
    const bool patch = t.unseen && !t.rim;
    if (patch || k % stride == 0) {
      by_face[static_cast<std::size_t>(side_of(t, surface))] +=
          (patch ? 1.0 : static_cast<double>(stride)) * t.area_mm2;
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
  if (main.state == RegionState::kRed) {
    region.reason = why_red(red, group, region.area_mm2);
  }
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
       cluster_targets(red, scans, 2.0 * red.cell_mm, kRegionGridReachMm, true, 1.8 * patch_mm)) {
    for (const auto& part : parts_by_side(red, group, surface)) {
      regions.push_back(region_of(red, part, surface));
    }
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const RedRegion& a, const RedRegion& b) { return a.area_mm2 > b.area_mm2; });
  return regions;
}

}  // namespace dubsar
