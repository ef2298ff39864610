// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/checklist.h"

#include <Eigen/Geometry>

#include "planning/convex_hull.h"
#include "planning/model_faces.h"

namespace dubsar {

namespace {

bool measured(const Mesh& mesh, const std::array<std::uint32_t, 3>& face) {
  if (mesh.flags.empty()) {
    return true;
  }
  for (const std::uint32_t v : face) {
    if ((mesh.flags[v] & kVertexInterpolated) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

Checklist make_checklist(const RedMap& map, std::span<const ScanPose> poses,
                         std::span<const PlacedScan> registered, const Mesh& mesh, const Rig* rig) {
  Checklist list;
  list.conclusive = map.conclusive;
  for (const ScanPose& pose : poses) {
    list.scans_registered += pose.status == PoseStatus::kRegistered ? 1 : 0;
    list.scans_unsure += pose.status == PoseStatus::kUnsure ? 1 : 0;
    list.scans_failed += pose.status == PoseStatus::kFailed ? 1 : 0;
  }
  if (rig != nullptr) {
    list.calibration = rig->calibration;
    list.calibration_age_days = rig->calibration_age_days;
  }
  const ModelFaces faces = model_faces(registered, hull_points(mesh.positions));
  for (const auto& f : mesh.faces) {
    if (measured(mesh, f)) {
      const Eigen::Vector3d a = mesh.positions[f[0]].cast<double>();
      const Eigen::Vector3d n =
          (mesh.positions[f[1]].cast<double>() - a).cross(mesh.positions[f[2]].cast<double>() - a);
      list.faces[static_cast<std::size_t>(faces.of(n))].seen_mm2 += 0.5 * n.norm();
    }
  }
  for (const RedRegion& region : map.regions) {
    FaceCoverage& face = list.faces[static_cast<std::size_t>(region.face)];
    (region.state == RegionState::kRed ? face.red_mm2 : face.excused_mm2) += region.area_mm2;
  }
  return list;
}

}  // namespace dubsar
