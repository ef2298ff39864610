// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/rig.h"
#include "planning/model_surface.h"

namespace dubsar {

/// A place of the tablet that has to lie in the middle of the scanner's field: its own middle, or another.
struct PlaceInField {
  Eigen::Vector3d offset_mm{0, 0, 0};  ///< model frame, from the tablet's middle, along the support
  std::string say;  ///< "lay the place 25 mm from its middle towards … under the scanner"
};

/// Where the tablet, lying so, is larger than the field: its middle first, then the places that have to lie
/// in the field one after the other for all of it to come under the scanner, whichever way a turntable turns
/// it. Else nothing: laid on its middle all of it is in the field. What nobody has seen yet may make it
/// larger than it looks, so that a tablet that reaches to the border of the field counts as larger.
/// stage_from_model: the rotation.
[[nodiscard]] std::vector<PlaceInField> places_in_field(const Rig& rig,
                                                        const Eigen::Matrix3d& stage_from_model,
                                                        const ModelSurface& surface);

/// How far above the tablet's middle the middle of the scanner's depth has to lie.
struct HeightInField {
  double above_mm = 0;  ///< along the stage's vertical
  std::string say;      ///< "bring the place 22 mm above its middle to the working distance"
};

/// Where the tablet, lying so, reaches farther up and down than the scanner sees in depth: its middle first,
/// then the heights that have to come to the working distance one after the other for all above it to be
/// sampled. What is below is above when it is turned over. Else nothing: with its middle there all of it is
/// in depth. stage_from_model: the rotation.
[[nodiscard]] std::vector<HeightInField> heights_in_field(const Rig& rig,
                                                          const Eigen::Matrix3d& stage_from_model,
                                                          const ModelSurface& surface);

}  // namespace dubsar
