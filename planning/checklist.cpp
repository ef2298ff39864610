// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/checklist.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/scan_copies.h"
#include "planning/model_faces.h"

namespace dubsar {

namespace {

void count_scans(std::span<const ScanPose> poses, Checklist& list) {
  for (const ScanPose& pose : poses) {
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

/// The scans that are measurements of their own; of the others a warning.
std::vector<PlacedScan> without_copies(std::span<const PlacedScan> registered, Checklist& list) {
  const std::vector<ScanCopy> copies = copies_among(registered);
  for (const ScanCopy& copy : copies) {
    list.warnings.push_back({copy.id, "it has the very samples of scan " + std::to_string(copy.of_id) +
                                          ", and counts as the same scan"});
  }
  std::vector<PlacedScan> once(registered.begin(), registered.end());
  std::erase_if(once, [&](const PlacedScan& scan) {
    return std::ranges::find(copies, scan.id, &ScanCopy::id) != copies.end();
  });
  return once;
}

}  // namespace

Checklist make_checklist(const RedMap& map, std::span<const ScanPose> poses,
                         std::span<const PlacedScan> registered, const Mesh& mesh, const Rig* rig) {
  Checklist list;
  list.conclusive = map.conclusive;
  count_scans(poses, list);
  if (rig != nullptr) {
    list.calibration = rig->calibration;
    list.calibration_age_days = rig->calibration_age_days;
    list.calibration_check = rig->calibration_check;
  }
  const std::vector<PlacedScan> once = without_copies(registered, list);
  const SurfaceQuality quality = surface_quality(once, mesh, model_faces(once, mesh.positions));
  list.sampling = quality.all;
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    list.faces[face].seen_mm2 = quality.seen_mm2[face];
    list.faces[face].interpolated_mm2 = quality.interpolated_mm2[face];
    list.faces[face].sampling = quality.faces[face];
  }
  add_regions(map, list);
  return list;
}

}  // namespace dubsar
