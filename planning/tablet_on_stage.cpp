// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/tablet_on_stage.h"

#include <algorithm>
#include <limits>

#include "core/sample_flags.h"
#include "core/sphere_directions.h"
#include "planning/convex_hull.h"

namespace dubsar {

namespace {

/// Pins on their arms reach this far beyond the tablet.
constexpr double kPinRoomMm = 40;

}  // namespace

TabletOnStage TabletOnStage::of(const StageState& state, const PlacedScan& last) {
  TabletOnStage out;
  const RigidTransform drive = stage_from_scanner(state.drive, Eigen::Vector3d::Zero());
  out.stage_from_model = drive.rotation * last.model_from_scanner.rotation.transpose();
  // Motors turn about the point that the scanner looks at.
  out.focus_mm = last.model_from_scanner.translation_mm;
  out.room_mm = last.grid->pin_tip_diameter_mm > 0 ? kPinRoomMm : 0.0;
  if (state.drive.free_pose) {
    out.measured = drive * last.model_from_scanner.inverse();
  }
  return out;
}

TabletOnStage TabletOnStage::turned(const RigidTransform& turn, const Eigen::Vector3d& center_mm) const {
  const Eigen::Matrix3d then = turn.rotation * stage_from_model;
  return {then, center_mm - then.transpose() * turn.translation_mm, std::nullopt, room_mm};
}

RigidTransform TabletOnStage::pose(const Rig& rig, std::span<const Eigen::Vector3d> points) const {
  if (measured) {
    return *measured;
  }
  const Eigen::Vector3d up = stage_from_model.row(2).transpose();
  double lowest = up.dot(focus_mm);
  for (const Eigen::Vector3d& p : points) {
    lowest = std::min(lowest, up.dot(p));
  }
  const Eigen::Vector3d focus_on_stage(0, 0, rig.support_height_mm + up.dot(focus_mm) - lowest);
  return {stage_from_model, focus_on_stage - stage_from_model * focus_mm};
}

StageScene TabletOnStage::scene(const Rig& rig, std::span<const Eigen::Vector3d> points) const {
  const RigidTransform stage = pose(rig, points);
  StageScene out;
  out.focus_mm = stage * focus_mm;
  for (const Eigen::Vector3d& p : points) {
    out.tablet_mm.extend(stage * p);
  }
  if (!out.tablet_mm.isEmpty()) {
    out.tablet_mm.min().array() -= room_mm;
    out.tablet_mm.max().array() += room_mm;
  }
  return out;
}

std::vector<Eigen::Vector3d> reach_points(std::span<const PlacedScan> scans) {
  constexpr std::size_t kPerScan = 8000;
  std::vector<Eigen::Vector3f> points;
  for (const PlacedScan& scan : scans) {
    const std::size_t stride = scan.grid->size() / kPerScan + 1;
    for (std::size_t i = 0; i < scan.grid->size(); i += stride) {
      if (scan.grid->valid[i] != 0 && ((*scan.flags)[i] & (kPotentiallySparse | kNotTablet)) == 0) {
        points.push_back((scan.model_from_scanner * scan.grid->point(i).cast<double>()).cast<float>());
      }
    }
  }
  constexpr std::size_t kDirections = 100;
  return extreme_points(points, sphere_directions(kDirections));
}

}  // namespace dubsar
