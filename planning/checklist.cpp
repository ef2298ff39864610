// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/checklist.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "core/parallel.h"
#include "planning/clearing.h"
#include "planning/model_faces.h"
#include "planning/sparse_flags.h"

namespace dubsar {

namespace {

void count_scans(std::span<const ScanPose> poses, std::span<const ScanCopy> copies, Checklist& list) {
  for (const ScanPose& pose : poses) {
    if (const std::optional<int> first = copied_from(copies, pose.id)) {
      list.warnings.push_back({pose.id, "it has the very samples of scan " + std::to_string(*first) +
                                            ", and counts as the same scan"});
      continue;
    }
    list.scans_registered += pose.status == PoseStatus::kRegistered ? 1 : 0;
    list.scans_unsure += pose.status == PoseStatus::kUnsure ? 1 : 0;
    list.scans_failed += pose.status == PoseStatus::kFailed ? 1 : 0;
    if (pose.status == PoseStatus::kRegistered && std::isfinite(pose.sigma_mm) &&
        (list.worst_sigma_scan < 0 || pose.sigma_mm > list.worst_sigma_mm)) {
      list.worst_sigma_mm = pose.sigma_mm;
      list.worst_sigma_scan = pose.id;
    }
    if (pose.status == PoseStatus::kRegistered && !pose.warning.empty()) {
      list.warnings.push_back({pose.id, pose.warning});
    }
  }
}

void add_regions(const RedMap& map, Checklist& list) {
  for (const RedRegion& region : map.regions) {
    if (is_stray(region)) {
      ++list.strays;
      continue;
    }
    FaceCoverage& face = list.faces[static_cast<std::size_t>(region.face)];
    const bool red = region.state == RegionState::kRed;
    (red ? face.red_mm2 : face.excused_mm2) += region.area_mm2;
    (red ? face.red_regions_mm2 : face.excused_regions_mm2).push_back(region.area_mm2);
  }
  for (FaceCoverage& face : list.faces) {
    std::ranges::sort(face.red_regions_mm2, std::greater<>());
    std::ranges::sort(face.excused_regions_mm2, std::greater<>());
  }
}

/// A scan with samples far apart counts as good as its own spacing is: what it saw is no longer red, though
/// the finer scans around it would tell a smaller gap.
void warn_of_coarse_scans(std::span<const PlacedScan> scans, Checklist& list) {
  constexpr double kMuchCoarser = 1.5;
  double finest_mm = std::numeric_limits<double>::infinity();
  for (const PlacedScan& scan : scans) {
    const double spacing_mm = spacing_of(*scan.grid);
    finest_mm = spacing_mm > 0 ? std::min(finest_mm, spacing_mm) : finest_mm;
  }
  for (const PlacedScan& scan : scans) {
    const double spacing_mm = spacing_of(*scan.grid);
    if (spacing_mm > kMuchCoarser * finest_mm) {
      list.warnings.push_back(
          {scan.id, "its samples lie " + short_text(spacing_mm, 2) + " mm apart, those of the finest scan " +
                        short_text(finest_mm, 2) + " mm: where it looked, gaps of up to " +
                        short_text(kGapInSpacings * spacing_mm, 2) +
                        " mm count as sampled; take it out if that is not meant"});
    }
  }
}

/// What only a scan much noisier than the others saw is worth as little as that scan, and its pose does not
/// show it.
void warn_of_noisy_scans(std::span<const PlacedScan> scans, Checklist& list) {
  constexpr double kMuchNoisier = 3.0;
  constexpr double kLeastInSpacings = 0.1;  ///< what scatters less is as good as any
  std::vector<double> noise_mm(scans.size());
  parallel_for_each_index(
      scans.size(), [&](std::size_t s) { noise_mm[s] = noise_of(scans[s]); }, 1);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<double> others_mm(noise_mm);
    others_mm.erase(others_mm.begin() + static_cast<std::ptrdiff_t>(s));
    if (others_mm.size() < 2) {
      return;
    }
    const auto middle = others_mm.begin() + static_cast<std::ptrdiff_t>(others_mm.size() / 2);
    std::ranges::nth_element(others_mm, middle);
    if (noise_mm[s] > std::max(kMuchNoisier * *middle, kLeastInSpacings * spacing_of(*scans[s].grid))) {
      list.warnings.push_back(
          {scans[s].id, "its samples scatter by " + fixed_text(1000 * noise_mm[s], 0) +
                            " µm, half of the other scans by no more than " + fixed_text(1000 * *middle, 0) +
                            " µm: clay that it alone saw is as noisy; take it out and scan that anew"});
    }
  }
}

}  // namespace

Checklist make_checklist(const RedMap& map, std::span<const ScanPose> poses,
                         std::span<const PlacedScan> registered, const Mesh& mesh, const Rig* rig) {
  Checklist list;
  list.conclusive = map.conclusive;
  count_scans(poses, map.copies, list);
  if (rig != nullptr) {
    list.calibration = rig->calibration;
    list.calibration_age_days = rig->calibration_age_days;
    list.calibration_check = rig->calibration_check;
  }
  std::vector<PlacedScan> once(registered.begin(), registered.end());
  std::erase_if(once, [&](const PlacedScan& scan) { return copied_from(map.copies, scan.id).has_value(); });
  const SurfaceQuality quality = surface_quality(once, mesh, model_faces(once, mesh.positions));
  list.sampling = quality.all;
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    list.faces[face].seen_mm2 = quality.seen_mm2[face];
    list.faces[face].interpolated_mm2 = quality.interpolated_mm2[face];
    list.faces[face].sampling = quality.faces[face];
  }
  add_regions(map, list);
  warn_of_coarse_scans(once, list);
  warn_of_noisy_scans(once, list);
  return list;
}

}  // namespace dubsar
