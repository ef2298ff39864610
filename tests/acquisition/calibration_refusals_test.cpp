// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What calibration refuses, leaves out and asks for, of views as a good detector would hand them over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/calibration.h"
#include "acquisition/mirror_axis.h"
#include "core/units.h"
#include "tests/acquisition/support/ideal_views.h"

namespace dubsar {
namespace {

using test::board;
using test::held_views;
using test::ideal_view;
using test::numbered;
using test::options_for;
using test::stage_views;
using test::truth_of;

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

/// A mirror that hardly moved while its pictures were taken.
TEST(Calibration, WhatIsOpenOfAMirrorsAxisCountsForItsPoints) {
  const RigCalibration truth = truth_of(MotionKind::kGalvanometer);
  std::vector<CalibrationView> views;
  Random random(7);
  for (const RigidTransform& pose : sim::board_poses(truth, board().low_mm(), board().high_mm(), 12, 3)) {
    const double mirror = 0.004 * (static_cast<double>(views.size() / 4) - 1);
    views.push_back(ideal_view(truth, pose, mirror, random, numbered("pose", views.size())));
  }
  CalibrationOptions options = options_for(MotionKind::kGalvanometer);
  const Result<CalibrationReport> open = calibrate_rig(views, options);
  const Result<CalibrationReport> known = calibrate_rig(held_views(truth, true), options);
  ASSERT_TRUE(open.has_value()) << open.error().line();
  ASSERT_TRUE(known.has_value()) << known.error().line();
  EXPECT_GT(open->rig.quality.volume_sigma_um, 1.2 * known->rig.quality.volume_sigma_um);
  options.most_volume_sigma_um = 0.95 * open->rig.quality.volume_sigma_um;
  const Result<CalibrationReport> refused = calibrate_rig(views, options);
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().what.find("points would be known to"), std::string::npos);
  EXPECT_NE(refused.error().mend.find("let the mirror go from"), std::string::npos) << refused.error().mend;
}

/// Of a stripe that runs down the picture the field was taken to be as wide as the stripe is short.
TEST(Calibration, AStripeThatRunsDownIsKnownNoBetter) {
  std::vector<CalibrationView> views = held_views();
  CalibrationOptions options = options_for(std::nullopt);
  const Result<CalibrationReport> across = calibrate_rig(views, options);
  ASSERT_TRUE(across.has_value()) << across.error().line();
  for (CalibrationView& view : views) {  // the same with x and y exchanged
    std::swap(view.board.width, view.board.height);
    for (Eigen::Vector3d& corner : view.board.corners_mm) {
      std::swap(corner.x(), corner.y());
    }
    for (std::vector<Eigen::Vector2d>* points : {&view.board.corners_px, &view.stripe_px}) {
      for (Eigen::Vector2d& point : *points) {
        std::swap(point.x(), point.y());
      }
    }
  }
  std::swap(options.board.cols, options.board.rows);
  const Result<CalibrationReport> down = calibrate_rig(views, options);
  ASSERT_TRUE(down.has_value()) << down.error().line();
  EXPECT_NEAR(down->rig.quality.volume_sigma_um / across->rig.quality.volume_sigma_um, 1, 0.03);
}

/// Its mirror was said not to move the stripe at all, and what is open of its axis to harm nothing.
TEST(Calibration, AMirrorWhoseStripeRunsDownIsDoubtedAsMuch) {
  const RigCalibration across = truth_of(MotionKind::kGalvanometer);
  RigCalibration down = across;
  std::swap(down.camera.width, down.camera.height);
  std::swap(down.camera.cx_px, down.camera.cy_px);
  std::swap(down.camera.p1, down.camera.p2);
  for (Eigen::Vector3d* v : {&down.laser.normal, &down.motion.direction, &down.motion.axis_point_mm}) {
    std::swap(v->x(), v->y());
  }
  const double doubt_rad = rad_from_deg(5);
  const double sigma_mm = mirror_axis_sigma_mm(across, doubt_rad);
  EXPECT_GT(sigma_mm, 5e-4);
  EXPECT_NEAR(mirror_axis_sigma_mm(down, doubt_rad), sigma_mm, 1e-6);
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
