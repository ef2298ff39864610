// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// What stands on the stage, as far as the motors have to know it: stage frame.
struct StageScene {
  Eigen::Vector3d focus_mm{0, 0, 0};  ///< what turntable and tilt turn the scanner about
  Eigen::AlignedBox3d tablet_mm;      ///< holds all that may be tablet
};

/// The head of the rig: the box that the device tells, or one that holds laser and camera on their whole way,
/// 30 mm of body around them. Nothing when neither is known: then nothing can be said of collisions.
[[nodiscard]] std::optional<HeadBox> head_of(const Rig& rig);

/// The scene while nobody has seen the tablet: the tablet may stand in any way anywhere in the measuring
/// volume, or, where its size is known, lie on any of its sides about the middle of the stage.
[[nodiscard]] StageScene unseen_tablet(const Rig& rig, const std::optional<Eigen::Vector3d>& size_mm);

/// Whether the head stands clear of the tablet (by the rig's margin) and above the support. With a turntable,
/// at whatever angle it stands. kUsage, saying which of the two it would touch. Always clear when the head is
/// not known.
[[nodiscard]] Status check_clear(const Rig& rig, const StageScene& scene, const Placement& placement,
                                 const std::string& where);

/// The same for all of the way between two placements, both included, and an arm's reach on it. Turntable and
/// tilt may move in any order: the tablet is taken for all that it sweeps in a full turn. An arm goes
/// straight: the centre of the measuring volume along a line, the turn by the shorter way at the same time.
/// The way is looked at every few millimetres with the head grown by as much, so that nothing is missed in
/// between.
[[nodiscard]] Status check_way(const Rig& rig, const StageScene& scene, const Placement& from,
                               const Placement& to, const std::string& where);

/// The placements to go through, the last being `to`, so that every part of the way is within limits and
/// clear. Without a known start only the goal is checked. An arm whose straight way is not clear backs off
/// along its own axis, goes round and comes in again; when that does not do, over the top. kUsage with what
/// is in the way when there is no such way. Checks are made before anything is returned, so nothing has
/// moved.
[[nodiscard]] Result<std::vector<Placement>> safe_way(const Rig& rig, const StageScene& scene,
                                                      const std::optional<Placement>& from,
                                                      const Placement& to, const std::string& where);

/// A part of the way, share in [0, 1], as check_way() takes it.
[[nodiscard]] Placement on_the_way(const Placement& from, const Placement& to, double share);

}  // namespace dubsar
