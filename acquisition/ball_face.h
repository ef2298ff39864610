// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "acquisition/sphere_fit.h"

namespace dubsar {

/// Of a ball what lies within this of the view counts: its face.
inline constexpr double kFaceDeg = 60;
/// Its face in three rings of the same area, each in eight.
inline constexpr std::size_t kFaceParts = 24;

/// The point is on the scanner's side of the ball, within 60° of the unit vector `towards` the scanner.
[[nodiscard]] bool before_face(const Eigen::Vector3d& point_mm, const Sphere& ball,
                               const Eigen::Vector3d& towards);

/// How many parts of the face were seen: hold a quarter or more of the samples that they would hold if all
/// samples lay evenly over the face as the scanner sees it.
[[nodiscard]] std::size_t seen_parts(const std::vector<Eigen::Vector3d>& on_face_mm, const Sphere& ball,
                                     const Eigen::Vector3d& towards);

}  // namespace dubsar
