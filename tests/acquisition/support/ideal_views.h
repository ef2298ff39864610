// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/calibration.h"
#include "core/random.h"
#include "sim/board_poses.h"
#include "sim/frame_rig.h"

namespace dubsar::test {

/// A third of the usual camera's pixels each way.
inline RigCalibration truth_of(MotionKind motion) {
  sim::FrameRigOptions options;
  options.width = 720;
  options.height = 400;
  options.motion = motion;
  return sim::frame_rig(options);
}

inline std::string numbered(std::string name, std::size_t number) {
  return name.append(std::to_string(number));
}

inline BoardSpec board() {
  return *parse_board("charuco:9x6:5:3.7");
}

/// A view as a good detector would hand it over, without any picture: corners to 0.05 px, stripe to 0.2 px.
inline CalibrationView ideal_view(const RigCalibration& truth, const RigidTransform& pose, double mirror,
                                  Random& random, const std::string& name) {
  CalibrationView view;
  view.board.name = name;
  view.board.width = truth.camera.width;
  view.board.height = truth.camera.height;
  view.mirror_position = mirror;
  const BoardSpec spec = board();
  for (int i = 0; i < spec.corner_count(); ++i) {
    const Eigen::Vector3d corner((i % (spec.cols - 1) + 1) * spec.square_mm,
                                 (i / (spec.cols - 1) + 1) * spec.square_mm, 0);
    const Eigen::Vector2d pixel = truth.camera.project(pose * corner);
    if (truth.camera.sees(pixel, 10)) {
      view.board.corners_mm.push_back(corner);
      view.board.corners_px.push_back(
          {pixel.x() + 0.05 * random.normal(), pixel.y() + 0.05 * random.normal()});
    }
  }
  const Plane laser = truth.motion.laser_at(truth.laser, mirror);
  const Plane face{pose.rotation.col(2), pose.rotation.col(2).dot(pose.translation_mm)};
  const Eigen::Vector3d along = face.normal.cross(laser.normal).normalized();
  Eigen::Matrix3d both;
  both << face.normal.transpose(), laser.normal.transpose(), along.transpose();
  const Eigen::Vector3d start =
      both.inverse() * Eigen::Vector3d(face.distance_mm, laser.distance_mm,
                                       along.dot(Eigen::Vector3d(0, 0, truth.working_distance_mm)));
  for (int i = -250; i <= 250; ++i) {
    const Eigen::Vector2d pixel = truth.camera.project(start + 0.1 * i * along);
    if (truth.camera.sees(pixel)) {
      view.stripe_px.emplace_back(pixel.x(), pixel.y() + 0.2 * random.normal());
    }
  }
  return view;
}

inline std::vector<CalibrationView> held_views(const RigCalibration& truth, bool mirror = false) {
  std::vector<CalibrationView> out;
  Random random(7);
  for (const RigidTransform& pose : sim::board_poses(truth, board().low_mm(), board().high_mm(), 12, 3)) {
    const double position = mirror ? 0.03 * (static_cast<double>(out.size() / 4) - 1) : 0;
    out.push_back(ideal_view(truth, pose, position, random, numbered("pose", out.size())));
  }
  return out;
}

inline std::vector<CalibrationView> held_views() {
  return held_views(truth_of(MotionKind::kLinear));
}

/// The board lying on the stage, which goes to each position.
inline std::vector<CalibrationView> stage_views(const RigCalibration& truth,
                                                const std::vector<double>& positions) {
  std::vector<CalibrationView> out;
  Random random(8);
  for (const RigidTransform& pose :
       sim::carried_board(truth, board().low_mm(), board().high_mm(), positions)) {
    out.push_back(ideal_view(truth, pose, 0, random, numbered("stage", out.size())));
    out.back().stripe_px.clear();
    out.back().stage_position = positions[out.size() - 1];
    out.back().fixed.assign(1, 'a');
  }
  return out;
}

inline CalibrationOptions options_for(std::optional<MotionKind> motion) {
  CalibrationOptions options;
  options.board = board();
  options.motion = motion;
  return options;
}

}  // namespace dubsar::test
