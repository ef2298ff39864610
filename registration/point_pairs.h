// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/pose_hint.h"
#include "core/result.h"

namespace dubsar {

/// Two clicks on one place come out at most this far apart: each is good to about 1 mm per axis.
inline constexpr double kMostClickMissMm = 5.0;
/// How far a rough pose may be off.
inline constexpr double kMostRoughShiftMm = 10.0;
inline constexpr double kMostRoughTurnRad = 0.3;

/// Whether the pairs can be of one rigid body and say something: kBadInput when there are none, when two of
/// them are one place, when three or more lie on one line, or when no pose brings them together (the error
/// then names the pair that the others contradict, where there are enough to tell). `where` goes into the
/// error.
[[nodiscard]] Status check_point_pairs(std::span<const PointPair> pairs, const std::string& where);

/// on_from_scanner of three or more pairs (Horn's absolute orientation, all weighted alike). Errors: those of
/// check_point_pairs, and fewer than three pairs.
[[nodiscard]] Result<RigidTransform> solve_point_pairs(std::span<const PointPair> pairs,
                                                       const std::string& where);

/// True when the pose brings every pair together to within kMostClickMissMm, or leaves a rough pose by no
/// more than that is off at `center_mm` (a point of the scan, in its frame).
[[nodiscard]] bool agrees_with(const PoseHint& hint, const RigidTransform& on_from_scanner,
                               const Eigen::Vector3d& center_mm);

}  // namespace dubsar
