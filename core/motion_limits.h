// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "core/rig.h"

namespace dubsar {

/// What an operator allows of a rig. What is not set stays as the device has it.
struct RigLimits {
  std::optional<Range> turntable_rad;
  std::optional<Range> tilt_rad;
  std::optional<Range> reach_mm, height_mm, standoff_mm;  ///< of an arm, see RobotReach
  bool no_hand_turns = false;
  std::optional<double> margin_mm;  ///< around the tablet; a smaller one than the rig's changes nothing
};

/// The rig within the limits: every range becomes what both allow, so that limits only ever narrow. A limit
/// on what the rig does not have is left aside. kBadInput, naming the range, when nothing is left of one.
[[nodiscard]] Result<Rig> narrowed(const Rig& rig, const RigLimits& limits, const std::string& where);

/// Whether the rig may be driven to the placement, by turntable, tilt and reach alone. kUsage, with the value
/// and the range that it lies outside.
[[nodiscard]] Status check_limits(const Rig& rig, const Placement& placement, const std::string& where);

/// Where an arm's reach, height and stand-off hold on the way between two placements, where its tilt is free.
[[nodiscard]] Status check_reach(const Rig& rig, const RigidTransform& stage_from_scanner,
                                 const std::string& where);

}  // namespace dubsar
