// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/keep_out.h"
#include "core/result.h"
#include "core/rig.h"
#include "planning/model_faces.h"

namespace dubsar {

struct MotorSteps {
  int turntable_steps = 18;     ///< of a full turn
  double tilt_step_deg = 17.5;  ///< at most; the range is cut into equal steps
  double arm_step_deg = 25.0;   ///< between the directions of one tilt, along the sphere
  int arm_rolls = 4;            ///< of the scanner about its axis
};

/// The placements that motors can be asked for, evenly over what the rig's limits allow: turntable times
/// tilt, or for an arm directions over the allowed part of the sphere about focus_mm (stage frame) times
/// rolls. A turntable that the rig lacks stays where `now` has it. What an arm does not reach is left out;
/// whether the head stands clear is not asked.
[[nodiscard]] std::vector<Placement> motor_placements(const Rig& rig, const Placement& now,
                                                      const Eigen::Vector3d& focus_mm,
                                                      const MotorSteps& steps);

/// Where a device that has just been opened scans first: as it stands (turntable and tilt 0) when the rig's
/// limits allow that, else as near to it as they do; an arm looks down from as straight above as it may.
/// kBadInput when no placement at all is within limits and clear of the scene: then nothing can be scanned.
[[nodiscard]] Result<Placement> first_placement(const Rig& rig, const StageScene& scene,
                                                const std::string& where);

/// "arm to the side of the top edge, 35° off the vertical, rolled 90°".
[[nodiscard]] std::string say_arm(const RigidTransform& stage_from_scanner,
                                  const Eigen::Matrix3d& stage_from_model, const ModelFaces& faces);

}  // namespace dubsar
