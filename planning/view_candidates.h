// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/rig.h"
#include "core/rigid_transform.h"
#include "planning/model_surface.h"
#include "planning/motor_placements.h"
#include "planning/view_prediction.h"

namespace dubsar {

/// Where the tablet lies now: the drive that a registered scan was taken with.
struct StageState {
  int scan_id = 0;  ///< a registered scan of the present placement by hand
  Placement drive;  ///< its turntable and tilt, or the arm's pose (hand_turn is not read)
};

/// A pose that can be asked for.
struct ViewCandidate {
  RigidTransform model_from_scanner;
  std::optional<Placement> placement;  ///< none without a rig
  std::optional<HiddenHalf> hidden;    ///< what the support covers
  bool by_hand = false;                ///< the tablet has to be lifted
  std::string say;
  bool leans = false;  ///< by hand: it has to be propped, on none of its sides
};

struct CandidateOptions {
  MotorSteps motors;
  int yaw_steps = 6;          ///< hand-made turns about the vertical, of a rig with no turntable
  int free_directions = 160;  ///< with no rig: directions all around
  int lean_directions = 80;   ///< of a rig that hardly tilts: all around, those of the sides among them
  int lean_yaw_steps = 3;     ///< as yaw_steps, for each of these
};

/// All poses that the rig allows: the tablet as it lies and on each of its other five sides (where the rig
/// allows hand turns), times what its motors can do within their limits (motor_placements()), without those
/// where the head would come into the keep-out volume around the model or touch the support. Where the tablet
/// is larger than the field (places_in_field()), on each side with one part of it after the other in the
/// field: pushed there by hand, or looked at there by an arm; likewise where it reaches beyond the scanner's
/// depth (heights_in_field()): raised and lowered by hand. Of a rig whose scanner hardly tilts the tablet is
/// propped by hand, too, so that it leans (ViewCandidate::leans). `last` is the scan that `state` speaks of:
/// it tells how the tablet really lies. The hand turn that is asked for goes from how the tablet lies by the
/// nominal pose, when the scan has one, so that errors of many turns do not add up.
[[nodiscard]] std::vector<ViewCandidate> rig_candidates(const Rig& rig, const StageState& state,
                                                        const PlacedScan& last, const ModelSurface& surface,
                                                        const CandidateOptions& options = {});

/// With no rig: the scanner of the last scan carried around the model's centre at its own stand-off, every
/// turn made by hand and said relative to the last scan.
[[nodiscard]] std::vector<ViewCandidate> free_candidates(const PlacedScan& last, const ModelSurface& surface,
                                                         const CandidateOptions& options = {});

}  // namespace dubsar
