// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/calibration.h"
#include "acquisition/stripe_points.h"
#include "sim/board_poses.h"
#include "sim/frame_renderer.h"

namespace dubsar {

/// Pictures of a board before a simulated rig, looked for and extracted as those of a real one.
class SimulatedBoard {
 public:
  SimulatedBoard(const RigCalibration& truth, const BoardSpec& spec, const sim::FrameOptions& laser_optics)
      : truth_(truth), spec_(spec), laser_optics_(laser_optics) {
    bright_ = laser_optics;
    bright_.ambient_signal = 0.4;
    stripe_.sigma_px = std::max(0.8, 1.2 * laser_optics.laser_sigma_mm / truth.field_per_px_mm());
    stripe_.least_peak = 8;
  }

  /// Nothing where the board was not found.
  [[nodiscard]] std::optional<CalibrationView> view(const RigidTransform& camera_from_board, bool with_laser,
                                                    double mirror, const std::string& name) {
    constexpr int kTexels = 80;
    const sim::BoardTarget target(board_pattern(spec_, kTexels), spec_.square_mm / kTexels, -spec_.low_mm(),
                                  camera_from_board);
    const GrayImage picture = sim::FrameRenderer(truth_, bright_).render(target, false, 0, ++frame_);
    Result<BoardView> board = find_board(picture.view(), spec_, name);
    if (!board) {
      return std::nullopt;
    }
    CalibrationView out;
    out.board = std::move(*board);
    out.mirror_position = mirror;
    if (with_laser) {
      const sim::FrameRenderer renderer(truth_, laser_optics_);
      const GrayImage on = renderer.render(target, true, mirror, ++frame_);
      const GrayImage off = renderer.render(target, false, mirror, ++frame_);
      StripeProfile profile;
      StripeExtractor(stripe_).extract(on.view(), off.view(), profile);
      out.stripe_px = stripe_points(profile, stripe_.axis);
    }
    return out;
  }

 private:
  RigCalibration truth_;
  BoardSpec spec_;
  sim::FrameOptions laser_optics_;
  sim::FrameOptions bright_;
  StripeOptions stripe_;
  std::uint64_t frame_ = 0;
};

/// The largest distance of the true laser plane from the one that was found, over the measuring volume.
[[nodiscard]] inline double plane_error_mm(const RigCalibration& truth, const RigCalibration& found) {
  const RigidTransform camera_from_scanner = truth.scanner_from_camera().inverse();
  const double half_field = 0.5 * truth.camera.width * truth.field_per_px_mm();
  double worst = 0;
  for (const double x : {-half_field, 0.0, half_field}) {
    for (const double z : {-0.5 * truth.depth_range_mm, 0.0, 0.5 * truth.depth_range_mm}) {
      worst = std::max(
          worst, std::abs(found.laser.signed_distance_mm(camera_from_scanner * Eigen::Vector3d(x, 0, z))));
    }
  }
  return worst;
}

/// The same question without the rigid motion that no measurement can see (where a camera has its centre and
/// which way it looks is known only as far as the principal point is): points of the laser plane all over the
/// picture, as the found calibration has them, laid on the true ones as well as can be; the largest distance
/// left. `mirrors`: the positions of a galvanometer whose planes are all taken together.
[[nodiscard]] inline double shape_error_mm(const RigCalibration& truth, const RigCalibration& found,
                                           const std::vector<double>& mirrors = {0.0}) {
  constexpr int kPixels = 63;
  const auto count = static_cast<Eigen::Index>(kPixels * mirrors.size());
  Eigen::Matrix3Xd is(3, count);
  Eigen::Matrix3Xd should(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<int>(i % kPixels);
    const double mirror = mirrors[static_cast<std::size_t>(i / kPixels)];
    const Eigen::Vector2d pixel((k % 9 + 0.5) / 9 * truth.camera.width,
                                (k / 9 + 0.5) / 7 * truth.camera.height);
    const auto point = [&](const RigCalibration& rig) -> Eigen::Vector3d {
      const Eigen::Vector2d ray = rig.camera.undistort(pixel).value_or(Eigen::Vector2d::Zero());
      const Eigen::Vector3d direction(ray.x(), ray.y(), 1);
      const Plane laser = rig.motion.laser_at(rig.laser, mirror);
      return laser.along(Eigen::Vector3d::Zero(), direction).value_or(0) * direction;
    };
    is.col(i) = point(found);
    should.col(i) = point(truth);
  }
  const Eigen::Matrix4d lay = Eigen::umeyama(is, should, false);
  const Eigen::Matrix3Xd laid =
      (lay.topLeftCorner<3, 3>() * is).colwise() + lay.topRightCorner<3, 1>().eval();
  return (laid - should).colwise().norm().maxCoeff();
}

}  // namespace dubsar
