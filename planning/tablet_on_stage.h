// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/keep_out.h"
#include "core/placed_scan.h"
#include "core/rig.h"
#include "planning/view_candidates.h"

namespace dubsar {

/// How the model lies on the stage, as a scan and the drive that it was taken with say.
struct TabletOnStage {
  Eigen::Matrix3d stage_from_model = Eigen::Matrix3d::Identity();  ///< rotation
  Eigen::Vector3d focus_mm{0, 0, 0};  ///< of the model: what turntable and tilt turn the scanner about
  /// Known with an arm: it stands in the stage frame, and so then does the model.
  std::optional<RigidTransform> measured;
  double room_mm = 0;  ///< that pins take around the model

  [[nodiscard]] static TabletOnStage of(const StageState& state, const PlacedScan& last);
  /// After a turn by hand about the model's centre (Placement::hand_turn).
  [[nodiscard]] TabletOnStage turned(const RigidTransform& turn, const Eigen::Vector3d& center_mm) const;
  /// The whole pose. points: of the model's hull; the lowest of them lies on the support (the support is not
  /// lower than that, whatever is not seen yet of the underside).
  [[nodiscard]] RigidTransform pose(const Rig& rig, std::span<const Eigen::Vector3d> points) const;
  [[nodiscard]] StageScene scene(const Rig& rig, std::span<const Eigen::Vector3d> points) const;
};

/// Some points that the model so far reaches to, over all scans, strays left out: good to a millimetre or so.
[[nodiscard]] std::vector<Eigen::Vector3d> reach_points(std::span<const PlacedScan> scans);

}  // namespace dubsar
