// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Calibration of simulated rigs from rendered pictures, against their truth.
#include "acquisition/calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "bench/support/simulated_calibration.h"
#include "core/random.h"
#include "core/units.h"
#include "sim/frame_rig.h"

namespace dubsar {
namespace {

/// A third of the usual camera's pixels each way.
RigCalibration truth_of(MotionKind motion) {
  sim::FrameRigOptions options;
  options.width = 720;
  options.height = 400;
  options.motion = motion;
  return sim::frame_rig(options);
}

std::string numbered(std::string name, std::size_t number) {
  return name.append(std::to_string(number));
}

BoardSpec board() {
  return *parse_board("charuco:9x6:5:3.7");
}

sim::FrameOptions optics() {
  sim::FrameOptions options;
  options.laser_sigma_mm = 0.06;
  options.ambient_signal = 0.02;
  return options;
}

/// A view as a good detector would hand it over, without any picture: corners to 0.05 px, stripe to 0.2 px.
CalibrationView ideal_view(const RigCalibration& truth, const RigidTransform& pose, double mirror,
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

std::vector<CalibrationView> held_views(const RigCalibration& truth, bool mirror = false) {
  std::vector<CalibrationView> out;
  Random random(7);
  for (const RigidTransform& pose : sim::board_poses(truth, board().low_mm(), board().high_mm(), 12, 3)) {
    const double position = mirror ? 0.03 * (static_cast<double>(out.size() / 4) - 1) : 0;
    out.push_back(ideal_view(truth, pose, position, random, numbered("pose", out.size())));
  }
  return out;
}

std::vector<CalibrationView> held_views() {
  return held_views(truth_of(MotionKind::kLinear));
}

/// The board lying on the stage, which goes to each position.
std::vector<CalibrationView> stage_views(const RigCalibration& truth, const std::vector<double>& positions) {
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

CalibrationOptions options_for(std::optional<MotionKind> motion) {
  CalibrationOptions options;
  options.board = board();
  options.motion = motion;
  return options;
}

/// What is found lies by the truth as far as it says itself.
void expect_found(const RigCalibration& truth, const CalibrationReport& report) {
  const RigCalibration& rig = report.rig;
  EXPECT_TRUE(rig.has_laser && rig.has_motion);
  EXPECT_TRUE(rig.check("rig").has_value());
  EXPECT_LT(std::abs(rig.camera.fx_px - truth.camera.fx_px), 4 * rig.quality.focal_sigma_px);
  // A pixel is 69 um here, three times as much as that of the camera that has to reach 20 um.
  EXPECT_LT(shape_error_mm(truth, rig), 0.03);
  EXPECT_LT(shape_error_mm(truth, rig), 4e-3 * rig.quality.volume_sigma_um);
  EXPECT_GT(rig.quality.volume_sigma_um, 0.5);
  EXPECT_LT(rig.quality.volume_sigma_um, 80);
  // The plane itself goes with the camera's frame, which the principal point leaves open by some 0.1 %.
  EXPECT_LT(plane_error_mm(truth, rig), 0.8);
}

TEST(Calibration, FindsCameraLaserAndSlideFromPictures) {
  const RigCalibration truth = truth_of(MotionKind::kLinear);
  SimulatedBoard camera(truth, board(), optics());
  std::vector<CalibrationView> views;
  for (const RigidTransform& pose : sim::board_poses(truth, board().low_mm(), board().high_mm(), 7, 3)) {
    if (auto view = camera.view(pose, true, 0, numbered("pose", views.size()))) {
      views.push_back(std::move(*view));
    }
  }
  EXPECT_EQ(views.size(), 7U);
  const std::vector<double> positions{-6, 0, 6};
  std::size_t i = 0;
  for (const RigidTransform& pose :
       sim::carried_board(truth, board().low_mm(), board().high_mm(), positions)) {
    auto view = camera.view(pose, false, 0, numbered("stage", i));
    ASSERT_TRUE(view.has_value());
    view->fixed.assign(1, 'a');
    view->stage_position = positions[i++];
    views.push_back(std::move(*view));
  }
  CalibrationOptions options = options_for(MotionKind::kLinear);
  options.most_volume_sigma_um = 80;  // so few and so coarse pictures give no more
  const Result<CalibrationReport> report = calibrate_rig(views, options);
  ASSERT_TRUE(report.has_value()) << report.error().line();
  expect_found(truth, *report);
  EXPECT_LT(report->rig.quality.corner_rms_px, 0.15);
  EXPECT_NEAR(report->rig.motion.direction.norm(), 1, 2e-3);
}

TEST(Calibration, FindsCameraLaserAndSlide) {
  const RigCalibration truth = truth_of(MotionKind::kLinear);
  std::vector<CalibrationView> views = held_views(truth);
  for (CalibrationView& view : stage_views(truth, {-6, -3, 0, 3, 6})) {
    views.push_back(std::move(view));
  }
  const Result<CalibrationReport> report = calibrate_rig(views, options_for(MotionKind::kLinear));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  expect_found(truth, *report);
  EXPECT_NEAR(report->rig.quality.corner_rms_px, 0.05 * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(report->rig.quality.stripe_rms_px, 0.2, 0.03);
  EXPECT_NEAR(report->rig.motion.direction.norm(), 1, 1e-3);
  // The angle between slide and laser plane is what shears a scan.
  EXPECT_GT(std::abs(report->rig.motion.direction.normalized().dot(report->rig.laser.normal)), 1 - 2e-6);
}

TEST(Calibration, FindsTheAxisOfATurntable) {
  const RigCalibration truth = truth_of(MotionKind::kTurntable);
  std::vector<CalibrationView> views = held_views(truth);
  for (CalibrationView& view : stage_views(truth, {-0.3, -0.15, 0, 0.15, 0.3})) {
    views.push_back(std::move(view));
  }
  const Result<CalibrationReport> report = calibrate_rig(views, options_for(MotionKind::kTurntable));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  expect_found(truth, *report);
  const RigMotion& motion = report->rig.motion;
  EXPECT_GT(motion.direction.dot(truth.motion.direction), std::cos(rad_from_deg(0.3)));
  const Eigen::Vector3d off = motion.axis_point_mm - truth.motion.axis_point_mm;
  EXPECT_LT((off - off.dot(truth.motion.direction) * truth.motion.direction).norm(), 1.0);  // of 250 mm
}

TEST(Calibration, FindsTheMirrorOfAGalvanometer) {
  const RigCalibration truth = truth_of(MotionKind::kGalvanometer);
  const Result<CalibrationReport> report =
      calibrate_rig(held_views(truth, true), options_for(MotionKind::kGalvanometer));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  expect_found(truth, *report);
  // What counts: the planes over the mirror's way. The axis itself is known less well, for it lies in all of
  // them.
  EXPECT_LT(shape_error_mm(truth, report->rig, {-0.03, 0.0, 0.03}), 0.06);
  EXPECT_GT(report->rig.motion.direction.dot(truth.motion.direction), std::cos(rad_from_deg(6)));
}

TEST(Calibration, WhatIsSaidOfAMirrorsAxisBringsItNearer) {
  const RigCalibration truth = truth_of(MotionKind::kGalvanometer);
  constexpr std::uint64_t seed = 3;  // the worse of two that were tried
  std::vector<CalibrationView> views = held_views(truth, true);
  Result<CalibrationReport> report = calibrate_rig(views, options_for(MotionKind::kGalvanometer));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  ASSERT_TRUE(report->mirror) << "so few pictures of so little of the mirror's way leave degrees open";
  EXPECT_EQ(report->missing.front(), report->mirror->say);
  EXPECT_NE(report->mirror->say.find("let the mirror go from -"), std::string::npos);
  const double doubt = report->rig.quality.axis_sigma_rad;
  EXPECT_GT(doubt, rad_from_deg(4));
  const std::vector<double> way{report->mirror->from, 0, report->mirror->to};
  const double bent_mm = shape_error_mm(truth, report->rig, way);
  Random random(seed);
  for (int round = 0; report->mirror && round < 3; ++round) {
    const MirrorAdvice advice = *report->mirror;
    ASSERT_LT(advice.from, -0.04);
    ASSERT_GT(advice.to, 0.04);
    int pose_number = 0;
    for (RigidTransform pose : sim::board_poses(truth, board().low_mm(), board().high_mm(), advice.poses,
                                                seed + static_cast<std::uint64_t>(round))) {
      const double mirror = advice.from + 0.5 * (advice.to - advice.from) * (pose_number++ % 3);
      // Where the stripe is: half of the way there keeps the board in the picture.
      const Plane laser = truth.motion.laser_at(truth.laser, mirror);
      pose.translation_mm.y() +=
          0.5 * laser.along({0, 0, truth.working_distance_mm}, Eigen::Vector3d::UnitY()).value();
      views.push_back(ideal_view(truth, pose, mirror, random, numbered("more", views.size())));
    }
    report = calibrate_rig(views, options_for(MotionKind::kGalvanometer));
    ASSERT_TRUE(report.has_value()) << report.error().line();
  }
  EXPECT_FALSE(report->mirror) << report->mirror->say;
  // 2 degrees are wanted; what the picture holds of the mirror's way gives 3.5, and says so.
  EXPECT_LT(report->rig.quality.axis_sigma_rad, rad_from_deg(3.5));
  const double off = std::acos(std::min(1.0, report->rig.motion.direction.dot(truth.motion.direction)));
  EXPECT_LT(off, rad_from_deg(3.5));
  EXPECT_LT(off, 2 * report->rig.quality.axis_sigma_rad);
  // What counts for a scan: the planes over all of the mirror's way.
  EXPECT_LT(shape_error_mm(truth, report->rig, way), 0.8 * bent_mm);
}

TEST(Calibration, LeavesOutAViewThatContradictsTheOthers) {
  std::vector<CalibrationView> views = held_views();
  for (Eigen::Vector2d& corner : views[2].board.corners_px) {
    corner.x() += 0.06 * (corner.y() - 200);  // the board was bent, or it was another one
    corner.y() += 3 * std::sin(corner.x() / 30);
  }
  const Result<CalibrationReport> report = calibrate_rig(views, options_for(std::nullopt));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  ASSERT_EQ(report->rig.quality.left_out.size(), 1U);
  EXPECT_NE(report->rig.quality.left_out[0].find("pose2"), std::string::npos);
}

TEST(Calibration, RefusesWithTheReason) {
  const auto reason = [](std::vector<CalibrationView> views, std::optional<MotionKind> motion) {
    const Result<CalibrationReport> report = calibrate_rig(views, options_for(motion));
    EXPECT_FALSE(report.has_value());
    return report ? std::string() : report.error().line();
  };
  const std::vector<CalibrationView> all = held_views();
  EXPECT_NE(reason({}, std::nullopt).find("0 pictures"), std::string::npos);
  EXPECT_NE(reason({all[0], all[1]}, std::nullopt).find("2 pictures"), std::string::npos);
  // The same pose again and again.
  std::vector<CalibrationView> one_pose(5, all[0]);
  for (std::size_t i = 0; i < one_pose.size(); ++i) {
    one_pose[i].board.corners_px[0].x() += 0.1 * static_cast<double>(i);  // five pictures, not one
  }
  EXPECT_NE(reason(one_pose, std::nullopt).find("tilt"), std::string::npos);
  // One picture, five times.
  EXPECT_NE(reason({all[0], all[0], all[0], all[0], all[0]}, std::nullopt).find("the same picture as pose0"),
            std::string::npos);
  // No board on the stage.
  EXPECT_NE(reason(all, MotionKind::kLinear).find("stage"), std::string::npos);
  // A picture of another camera.
  std::vector<CalibrationView> mixed = all;
  mixed[1].board.width = 640;
  EXPECT_NE(reason(mixed, std::nullopt).find("pixels"), std::string::npos);
  // The laser was moved half way.
  std::vector<CalibrationView> moved = all;
  for (std::size_t i = 0; i < moved.size() / 2; ++i) {
    for (Eigen::Vector2d& p : moved[i].stripe_px) {
      p.y() += 25;
    }
  }
  EXPECT_NE(reason(moved, std::nullopt).find("laser"), std::string::npos);
}

TEST(Calibration, APictureThatIsNamedTwiceCountsOnce) {
  const std::vector<CalibrationView> once = held_views();
  std::vector<CalibrationView> twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const Result<CalibrationReport> alone = calibrate_rig(once, options_for(std::nullopt));
  const Result<CalibrationReport> report = calibrate_rig(twice, options_for(std::nullopt));
  ASSERT_TRUE(alone && report);
  EXPECT_EQ(report->rig.quality.board_views, 12);
  ASSERT_EQ(report->rig.quality.left_out.size(), 12U);
  EXPECT_EQ(report->rig.quality.left_out[3], "pose3: the same picture as pose3");
  EXPECT_EQ(report->rig.quality.focal_sigma_px, alone->rig.quality.focal_sigma_px);
}

TEST(Calibration, APictureOfTheLaserWithoutAStripeIsNamed) {
  std::vector<CalibrationView> views = held_views();
  for (CalibrationView& view : views) {
    view.laser_picture = view.board.name + "_laser";
  }
  views[4].stripe_px.clear();
  const Result<CalibrationReport> report = calibrate_rig(views, options_for(std::nullopt));
  ASSERT_TRUE(report.has_value()) << report.error().line();
  const auto is_named = [&](const std::string& picture) {
    return std::ranges::any_of(report->rig.quality.left_out, [&](const std::string& line) {
      return line.starts_with(picture + ": no stripe on the board");
    });
  };
  EXPECT_TRUE(is_named("pose4_laser"));
  EXPECT_FALSE(is_named("pose3_laser"));
}

/// Board and slide both say what a millimetre is.
TEST(Calibration, TellsAndThenRefusesAStageWhoseMillimetreIsNotTheBoards) {
  const RigCalibration truth = truth_of(MotionKind::kLinear);
  const auto scaled = [&](double share) {
    std::vector<CalibrationView> views = held_views(truth);
    for (CalibrationView& view : stage_views(truth, {-6, -3, 0, 3, 6})) {
      view.stage_position *= share;
      views.push_back(std::move(view));
    }
    return calibrate_rig(views, options_for(MotionKind::kLinear));
  };
  const auto told = [](const Result<CalibrationReport>& report) {
    return std::ranges::count_if(
        report->missing, [](const std::string& line) { return line.starts_with("1 mm of the stage"); });
  };
  const Result<CalibrationReport> right = scaled(1.001);
  ASSERT_TRUE(right.has_value()) << right.error().line();
  EXPECT_EQ(told(right), 0);
  for (const double share : {0.98, 1.02}) {
    const Result<CalibrationReport> off = scaled(share);
    ASSERT_TRUE(off.has_value()) << off.error().line();
    EXPECT_EQ(told(off), 1);
  }
  for (const double share : {0.8, 1.1}) {
    const Result<CalibrationReport> wrong = scaled(share);
    ASSERT_FALSE(wrong.has_value()) << share;
    EXPECT_NE(wrong.error().what.find("1 mm of the stage is "), std::string::npos);
  }
}

TEST(Calibration, ALargerDepthRangeNeverClaimsToBeKnownBetter) {
  const RigCalibration truth = truth_of(MotionKind::kLinear);
  double before = 0;
  for (const double depth : {20.0, 40.0, 80.0, 150.0, 400.0}) {
    CalibrationOptions options = options_for(std::nullopt);
    options.depth_range_mm = depth;
    const Result<CalibrationReport> report = calibrate_rig(held_views(truth), options);
    ASSERT_TRUE(report.has_value()) << report.error().line();
    EXPECT_GE(report->rig.quality.volume_sigma_um, (1 - 1e-6) * before) << depth;
    before = report->rig.quality.volume_sigma_um;
    const bool told = std::ranges::any_of(
        report->missing, [](const std::string& line) { return line.starts_with("the picture holds "); });
    EXPECT_EQ(told, depth > 60) << depth;
  }
}

TEST(Calibration, RefusesAStageThatTheBoardDidNotFollow) {
  const RigCalibration truth = truth_of(MotionKind::kTurntable);
  CalibrationOptions options = options_for(MotionKind::kTurntable);
  const auto refused = [&](const std::vector<CalibrationView>& on_stage) {
    std::vector<CalibrationView> views = held_views(truth);
    views.insert(views.end(), on_stage.begin(), on_stage.end());
    const Result<CalibrationReport> report = calibrate_rig(views, options);
    return report ? std::string() : report.error().line();
  };
  // Somebody touched the board: the last two pictures show it half a millimetre away.
  std::vector<CalibrationView> touched = stage_views(truth, {-0.3, -0.15, 0, 0.15, 0.3});
  for (std::size_t i = 3; i < touched.size(); ++i) {
    for (Eigen::Vector2d& corner : touched[i].board.corners_px) {
      corner.x() += 7;
    }
  }
  EXPECT_NE(refused(touched).find("the board on the stage is off by"), std::string::npos) << refused(touched);
  // A degree in all says little of where the axis points; corners as good as these say enough for the
  // default.
  options.most_turntable_axis_rad = 0.002;
  const std::string little = refused(stage_views(truth, {-0.011, 0, 0.011}));
  EXPECT_NE(little.find("the turntable's axis is known to"), std::string::npos) << little;
}

/// Of a laser that stands beside the camera the stripe runs down the picture.
TEST(Calibration, AsksForTheSideThatAStripeRunningDownDidNotReach) {
  std::vector<CalibrationView> views = held_views();
  const Result<Intrinsics> whole = find_intrinsics(views);
  ASSERT_TRUE(whole.has_value());
  for (CalibrationView& view : views) {
    view.stripe_px.clear();
    for (int y = 0; y < view.board.height / 2; y += 4) {
      view.stripe_px.emplace_back(0.5 * view.board.width, y);
    }
  }
  const Plane laser{.normal = {0.8, 0, 0.6}, .distance_mm = 150};
  const std::vector<std::string> missing = missing_poses(views, *whole, board(), &laser);
  const auto asks = [&](const char* side) {
    return std::ranges::count(
        missing, std::string("show the laser on the board at the ") + side + " side of the picture");
  };
  EXPECT_EQ(asks("lower"), 1);
  EXPECT_EQ(asks("upper") + asks("left") + asks("right"), 0);
}

TEST(Calibration, AsksForThePosesThatAreMissing) {
  std::vector<CalibrationView> views = held_views();
  const Result<Intrinsics> whole = find_intrinsics(views);
  ASSERT_TRUE(whole.has_value());
  const auto tilts = [](const std::vector<std::string>& missing) {
    return std::count_if(missing.begin(), missing.end(), [](const std::string& say) {
      return say.find("tilt the board") != std::string::npos;
    });
  };
  EXPECT_EQ(tilts(missing_poses(views, *whole, board(), nullptr)), 0);
  // Only those whose right side is nearer.
  Intrinsics right = *whole;
  right.used.clear();
  right.camera_from_board.clear();
  for (std::size_t k = 0; k < whole->used.size(); ++k) {
    if (whole->camera_from_board[k].rotation(0, 2) > 0.2) {
      right.used.push_back(whole->used[k]);
      right.camera_from_board.push_back(whole->camera_from_board[k]);
    }
  }
  ASSERT_GT(right.used.size(), 0U);
  const std::vector<std::string> missing = missing_poses(views, right, board(), nullptr);
  EXPECT_TRUE(std::any_of(missing.begin(), missing.end(), [](const std::string& say) {
    return say.find("its left side") != std::string::npos;
  }));
  EXPECT_TRUE(std::none_of(missing.begin(), missing.end(), [](const std::string& say) {
    return say.find("its right side") != std::string::npos;
  }));
}

}  // namespace
}  // namespace dubsar
