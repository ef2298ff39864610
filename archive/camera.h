// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "core/red_map.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// An orthographic camera. The rows of view_from_model are the picture's right, the picture's up and the
/// direction towards the viewer: a right-handed frame. Orthographic pictures are to scale all over.
struct ViewCamera {
  Eigen::Matrix3d view_from_model = Eigen::Matrix3d::Identity();
  std::string name;  ///< for people and file names
};

/// The six views in file order: `01_top 02_left 03_front 04_right 05_bottom 06_back`.
inline constexpr std::array<Face, kFaceCount> kSixViewOrder = {Face::kTop,   Face::kLeft,   Face::kObverse,
                                                               Face::kRight, Face::kBottom, Face::kReverse};

/// The file stem of a face's view, such as "03_front".
[[nodiscard]] const char* view_file_stem(Face face);

/// The camera that looks straight at a face. In the tablet frame x points to the reader's right along the
/// lines of writing, y to the top edge, z out of the obverse. A tablet is turned over about its horizontal
/// axis, so the views unroll round it: the top edge is seen with the obverse below it, the bottom edge with
/// the obverse above it, the reverse with the bottom edge above it; the left and the right edge stand upright
/// with the obverse beside them.
[[nodiscard]] ViewCamera face_camera(Face face, const RigidTransform& tablet_from_model = {});

/// A free camera: `towards_viewer` points from the object to the viewer, `up` is what appears upwards (its
/// part across the line of sight; any other direction is taken when it has none). Lengths don't matter.
[[nodiscard]] ViewCamera free_camera(const Eigen::Vector3d& towards_viewer, const Eigen::Vector3d& up);

}  // namespace dubsar
