// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an operator is told to do with the tablet by hand.
#pragma once

#include <Eigen/Core>
#include <string>

#include "planning/model_faces.h"

namespace dubsar {

/// A turn in words that say it whole, so that hands can make it: "turn the top edge towards the camera, 40°";
/// where the face that comes looks away, the way round is named ("turn the reverse towards the camera, 140°,
/// by way of the left edge"), and so is what is to be turned about the line of sight afterwards (", and turn
/// it where it lies, 60° clockwise seen from the camera"). Ways are told to half a corner, about 22°.
/// `turn` is a rotation in the frame of `up`, which points to the camera; frame_from_model puts the faces
/// into it, before the turn.
[[nodiscard]] std::string say_turn(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& frame_from_model,
                                   const Eigen::Vector3d& up, const ModelFaces& faces);

}  // namespace dubsar
