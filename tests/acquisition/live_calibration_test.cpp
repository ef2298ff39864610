// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A calibration taken with the rig itself: a simulated camera and stage behind the driver interface, and an
// operator who holds a board before them.
#include "acquisition/live_calibration.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <thread>

#include "acquisition/calibration_folder.h"
#include "bench/support/simulated_calibration.h"
#include "formats/atomic_file.h"
#include "sim/board_poses.h"
#include "tests/acquisition/rig_bench.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

constexpr const char* kBoard = "charuco:9x6:5:3.7";
constexpr int kTexels = 40;

class Live : public testing::Test {
 protected:
  Live() {
    sim::FrameRigOptions size;
    size.width = 720;
    size.height = 400;
    bench_.truth = sim::frame_rig(size);
    bench_.limit = 10;
    bench_.settable = true;
    bench_.optics.laser_sigma_mm = 0.06;
    bench_.optics.laser_signal = 0.25;
    bench_.optics.ambient_signal = 0.25;
    bench_.look = [this](const test::RigBench& bench) {
      const RigidTransform pose = shaking_ ? shaken(held_, bench.frames) : held_;
      const RigidTransform there =
          carried_ ? sim::carried_board(bench.truth, spec_.low_mm(), spec_.high_mm(), {bench.position})[0]
                   : pose;
      const sim::BoardTarget target(pattern_, spec_.square_mm / kTexels, -spec_.low_mm(), there);
      // A board that is held still looks the same twice.
      const bool same = seen_from_ && seen_from_->translation_mm == there.translation_mm &&
                        seen_from_->rotation == there.rotation;
      std::optional<GrayImage>& kept = bench.laser > 0 ? lit_ : dark_;
      if (!same) {
        lit_.reset();
        dark_.reset();
        seen_from_ = there;
      }
      if (!kept) {
        kept = sim::FrameRenderer(bench.truth, bench.optics)
                   .render(target, bench.laser > 0, bench.position, bench.frames);
      }
      return *kept;
    };
    plan_.set.board = kBoard;
    plan_.set.motion = MotionKind::kLinear;
    plan_.set.depth_range_mm = 30;  // more than this camera of few pixels is refused for
    plan_.set.stripe_sigma_px = 1.2;
    plan_.folder = folder_.path() / "pictures";
    plan_.from = -6;
    plan_.to = 6;
    plan_.stops = 4;
  }
  static RigidTransform shaken(RigidTransform pose, std::uint64_t frame) {
    pose.translation_mm.x() += 0.4 * static_cast<double>(frame % 7);
    return pose;
  }
  Result<LiveCalibration> start() {
    return LiveCalibration::start(plan_, test::camera_of(bench_), test::stage_of(bench_), JobContext{});
  }
  std::vector<RigidTransform> poses(int count) const {
    return sim::board_poses(bench_.truth, spec_.low_mm(), spec_.high_mm(), count, 3);
  }

  test::TemporaryFolder folder_;
  test::RigBench bench_;
  BoardSpec spec_ = *parse_board(kBoard);
  GrayImage pattern_ = board_pattern(spec_, kTexels);
  RigidTransform held_;
  std::optional<RigidTransform> seen_from_;
  std::optional<GrayImage> lit_, dark_;
  bool carried_ = false;
  bool shaking_ = false;
  LiveCalibrationPlan plan_;
};

TEST_F(Live, LeadsAnOperatorToACalibration) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value()) << live.error().line();
  ASSERT_EQ(live->next().size(), 1U);
  EXPECT_NE(live->next()[0].find("right side nearer"), std::string::npos);
  const std::vector<RigidTransform> all = poses(12);
  // Nothing to see, then a board that is not held still: of no use, and nothing is kept.
  held_.translation_mm = {500, 0, 250};
  EXPECT_FALSE(live->take_pose(JobContext{})->used);
  held_ = all[0];
  shaking_ = true;
  const auto moved = live->take_pose(JobContext{});
  ASSERT_TRUE(moved.has_value());
  EXPECT_FALSE(moved->used);
  EXPECT_NE(moved->said.find("moved"), std::string::npos);
  EXPECT_EQ(live->poses(), 0);
  EXPECT_FALSE(std::filesystem::exists(plan_.folder / "pose_00.png"));
  shaking_ = false;
  for (const RigidTransform& pose : all) {
    held_ = pose;
    const auto taken = live->take_pose(JobContext{});
    ASSERT_TRUE(taken.has_value()) << taken.error().line();
    EXPECT_TRUE(taken->used) << taken->said;
    EXPECT_EQ(bench_.laser, 0) << "off when it is done";
    if (live->poses() == 6) {
      // Half way it knows what it has not seen.
      EXPECT_FALSE(live->next().empty());
      EXPECT_NE(live->next().back().find("stage"), std::string::npos);
    }
  }
  carried_ = true;
  const auto stops = live->take_stops(JobContext{});
  ASSERT_TRUE(stops.has_value()) << stops.error().line();
  EXPECT_TRUE(stops->used) << stops->said;
  EXPECT_EQ(live->stops(), 4);
  const Result<CalibrationReport> report = live->calibrate();
  ASSERT_TRUE(report.has_value()) << report.error().line();
  EXPECT_EQ(live->next(), report->missing);
  EXPECT_LT(shape_error_mm(bench_.truth, report->rig), 0.1);
  EXPECT_LT((report->rig.motion.direction - bench_.truth.motion.direction).norm(), 0.01);
  EXPECT_EQ(report->rig.camera_serial, "SIM-CAMERA");
  // What lies in the folder says the same.
  const std::string list = (plan_.folder / "calibration.toml").string();
  const auto set = parse_calibration_set(read_whole_file(list).value(), list);
  ASSERT_TRUE(set.has_value()) << set.error().line();
  const auto pictures = look_at_pictures(plan_.folder, *set, JobContext{});
  ASSERT_TRUE(pictures.has_value());
  EXPECT_EQ(pictures->views.size(), all.size() + 4);
  EXPECT_TRUE(pictures->left_out.empty());
  EXPECT_GT(pictures->views[3].stripe_px.size(), 50U);
}

TEST_F(Live, GoesOnWithWhatWasTakenAndRefusesAnothersPictures) {
  {
    Result<LiveCalibration> live = start();
    ASSERT_TRUE(live.has_value());
    held_ = poses(2)[0];
    ASSERT_TRUE(live->take_pose(JobContext{})->used);
  }
  {
    Result<LiveCalibration> again = start();
    ASSERT_TRUE(again.has_value()) << again.error().line();
    EXPECT_EQ(again->poses(), 1);
    held_ = poses(2)[1];
    ASSERT_TRUE(again->take_pose(JobContext{})->used);
    EXPECT_TRUE(std::filesystem::exists(plan_.folder / "pose_01_dark.png"));
  }
  bench_.serial = "ANOTHER";
  const Result<LiveCalibration> another = start();
  ASSERT_FALSE(another.has_value());
  EXPECT_EQ(another.error().kind, ErrorKind::kBadInput);
}

/// A list that somebody wrote counts as it likes, and may have lost some of its lines.
TEST_F(Live, WhatIsTakenIsWrittenOverNoPicture) {
  std::filesystem::create_directories(plan_.folder);
  const std::array<std::filesystem::path, 2> others{plan_.folder / "pose_00_laser.png",
                                                    plan_.folder / "stage_01.png"};
  for (const std::filesystem::path& other : others) {
    ASSERT_TRUE(write_file_atomically(other, "a person's"));
  }
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value()) << live.error().line();
  held_ = poses(1)[0];
  ASSERT_TRUE(live->take_pose(JobContext{})->used);
  carried_ = true;
  ASSERT_TRUE(live->take_stops(JobContext{})->used);
  const std::string list = (plan_.folder / "calibration.toml").string();
  const auto set = parse_calibration_set(read_whole_file(list).value(), list);
  ASSERT_TRUE(set.has_value()) << set.error().line();
  ASSERT_EQ(set->poses.size(), 1U);
  EXPECT_EQ(set->poses[0].board, "pose_01.png");
  EXPECT_EQ(set->poses[0].dark, "pose_01_dark.png");
  ASSERT_EQ(set->stops.size(), 4U);
  EXPECT_EQ(set->stops[0].board, "stage_00.png");
  EXPECT_EQ(set->stops[1].board, "stage_02.png");
  EXPECT_EQ(set->stops[3].board, "stage_04.png");
  for (const std::filesystem::path& other : others) {
    EXPECT_EQ(read_whole_file(other).value_or(""), "a person's") << other;
  }
}

TEST_F(Live, GoesOnWithTheOptionsThatAreGivenAnew) {
  held_ = poses(1)[0];
  plan_.depth_range_mm = 25;
  plan_.plate_margin_mm = 3;
  ASSERT_TRUE(start()->take_pose(JobContext{})->used);
  plan_.depth_range_mm = 30;
  plan_.plate_margin_mm.reset();
  plan_.set.stripe_sigma_px = 2;
  ASSERT_TRUE(start()->take_pose(JobContext{})->used);
  const std::string list = (plan_.folder / "calibration.toml").string();
  const auto set = parse_calibration_set(read_whole_file(list).value(), list);
  ASSERT_TRUE(set.has_value()) << set.error().line();
  EXPECT_EQ(set->depth_range_mm, 30);
  EXPECT_EQ(set->plate_margin_mm, 3);
  EXPECT_EQ(set->stripe_sigma_px, 2);
  EXPECT_EQ(set->poses.size(), 2U);
}

/// With an exposure for the stripe alone, the board is seen with the one that the camera stood at.
TEST_F(Live, EachKindOfPictureHasItsExposure) {
  plan_.laser_exposure_us = 300;
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value()) << live.error().line();
  for (const RigidTransform& pose : poses(2)) {
    held_ = pose;
    ASSERT_TRUE(live->take_pose(JobContext{})->used);
  }
  EXPECT_EQ(bench_.lit_us, (std::vector{300.0, 300.0}));
  // Board, dark beside the stripe, board; twice.
  EXPECT_EQ(bench_.unlit_us, (std::vector{2000.0, 300.0, 2000.0, 2000.0, 300.0, 2000.0}));
}

TEST_F(Live, ARegionThatNoScanCouldUseIsRefused) {
  bench_.offset_x = 64;
  held_ = poses(1)[0];
  const auto taken = start()->take_pose(JobContext{});
  ASSERT_FALSE(taken.has_value());
  EXPECT_NE(taken.error().line().find("begins at pixel 64, 0"), std::string::npos) << taken.error().line();
}

TEST_F(Live, FailuresLeaveTheLaserOff) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value());
  held_ = poses(1)[0];
  bench_.gone_after = 2;
  const auto gone = live->take_pose(JobContext{});
  ASSERT_FALSE(gone.has_value());
  EXPECT_EQ(gone.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(bench_.laser, 0);
  bench_.gone_after = 1 << 30;
  bench_.mute = true;
  const auto lost = live->take_stops(JobContext{});
  ASSERT_FALSE(lost.has_value());
  EXPECT_NE(lost.error().what.find("does not tell where its axis 0 is"), std::string::npos);
  plan_.folder = folder_.path() / "other";
  plan_.to = 100;
  const Result<LiveCalibration> far = start();
  ASSERT_FALSE(far.has_value());
  EXPECT_NE(far.error().what.find("limits"), std::string::npos);
  plan_.set.board = "charuco:1x1:0:0";
  EXPECT_FALSE(start().has_value());
}

TEST_F(Live, ALaserThatCannotBePutOffIsTold) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value());
  held_ = poses(1)[0];
  bench_.burns_on = true;
  const auto taken = live->take_pose(JobContext{});
  ASSERT_FALSE(taken.has_value());
  EXPECT_NE(taken.error().line().find("the laser may still be on"), std::string::npos)
      << taken.error().line();
}

/// The operator has just laid the board there, and sits beside it.
TEST_F(Live, TheStageGoesAsFastAsTheRigSays) {
  plan_.speed = 1.5;
  Result<LiveCalibration> slide = start();
  ASSERT_TRUE(slide.has_value()) << slide.error().line();
  carried_ = true;
  ASSERT_TRUE(slide->take_stops(JobContext{}).has_value());
  EXPECT_EQ(bench_.speed, 1.5);
  ASSERT_EQ(bench_.sent.size(), 5U);
  EXPECT_LT(bench_.sent[0], plan_.from) << "its first stop too is driven to from below";
  bench_.truth.motion.kind = MotionKind::kGalvanometer;
  bench_.speed = 0;
  plan_.set.motion = MotionKind::kGalvanometer;
  plan_.folder = folder_.path() / "mirror";
  plan_.from = -0.01;
  plan_.to = 0.01;
  const Result<LiveCalibration> without_zero = start();
  ASSERT_FALSE(without_zero.has_value());
  EXPECT_NE(without_zero.error().what.find("no reference switch"), std::string::npos);
  bench_.can_home = true;
  Result<LiveCalibration> mirror = start();
  ASSERT_TRUE(mirror.has_value()) << mirror.error().line();
  ASSERT_TRUE(mirror->take_pose(JobContext{}).has_value());
  EXPECT_EQ(bench_.speed, 1.5);
}

/// A scan goes by where the mirror says it is.
TEST_F(Live, AMirrorIsCalibratedWhereItsStepsTakeIt) {
  sim::FrameRigOptions size;
  size.width = 720;
  size.height = 400;
  size.motion = MotionKind::kGalvanometer;
  bench_.truth = sim::frame_rig(size);
  bench_.can_home = true;
  bench_.whole_step = 0.005;
  plan_.set.motion = MotionKind::kGalvanometer;
  plan_.from = -0.0112;
  plan_.to = 0.0112;
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value()) << live.error().line();
  held_ = poses(1)[0];
  const auto taken = live->take_pose(JobContext{});
  ASSERT_TRUE(taken.has_value()) << taken.error().line();
  ASSERT_TRUE(taken->used) << taken->said;
  const std::string list = (plan_.folder / "calibration.toml").string();
  const auto set = parse_calibration_set(read_whole_file(list).value(), list);
  ASSERT_TRUE(set.has_value()) << set.error().line();
  ASSERT_EQ(set->poses.size(), 1U);
  EXPECT_NEAR(set->poses[0].mirror_rad, -0.01, 1e-9);
}

TEST_F(Live, ACancelledOneEndsTheMoveAndLightsNothing) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value());
  held_ = poses(1)[0];
  for (const bool halted : {false, true}) {
    bench_.asked.clear();
    bench_.far = true;
    JobContext job;
    std::jthread presses([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      halted ? job.halt() : job.cancel();
    });
    const auto stopped = live->take_stops(job);
    ASSERT_FALSE(stopped.has_value());
    EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
    EXPECT_NE(bench_.asked.find(halted ? 'E' : 'S'), std::string::npos) << bench_.asked;
    const auto pose = live->take_pose(job);
    ASSERT_FALSE(pose.has_value());
    EXPECT_EQ(pose.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(bench_.asked.find('L'), std::string::npos) << bench_.asked;
    EXPECT_EQ(bench_.laser, 0);
    bench_.far = false;
  }
  EXPECT_EQ(live->stops(), 0);
}

/// Whoever pressed it is told what the scans of this rig would tell, and not that all is well.
TEST_F(Live, AStopThatTheStageDoesNotObeyIsTold) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value());
  held_ = poses(1)[0];
  for (const bool halted : {false, true}) {
    const std::string said = halted ? "the emergency stop was pressed, but laser and motors may still be on: "
                                    : "stopped, but laser and motors may still be on: ";
    for (const bool at_stops : {false, true}) {
      bench_.deaf = true;
      bench_.stale = at_stops ? 0 : 1 << 30;
      bench_.far = at_stops;
      JobContext job;
      std::jthread presses([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        halted ? job.halt() : job.cancel();
      });
      const auto stopped = at_stops ? live->take_stops(job) : live->take_pose(job);
      ASSERT_FALSE(stopped.has_value());
      EXPECT_EQ(stopped.error().kind, ErrorKind::kDevice);
      EXPECT_EQ(stopped.error().what, said + "the controller does not answer");
      EXPECT_NE(stopped.error().mend.find("pull the plugs"), std::string::npos);
    }
  }
}

TEST_F(Live, AStopOfItsHomingThatTheStageDoesNotObeyIsTold) {
  bench_.deaf = true;
  JobContext job;
  job.cancel();
  const auto stopped = LiveCalibration::start(plan_, test::camera_of(bench_), test::stage_of(bench_), job);
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().what,
            "stopped, but laser and motors may still be on: the controller does not answer");
}

TEST_F(Live, ACancelledOneWaitsForNoPicture) {
  Result<LiveCalibration> live = start();
  ASSERT_TRUE(live.has_value());
  bench_.stale = 1 << 30;
  JobContext job;
  std::jthread presses([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    job.cancel();
  });
  const auto pose = live->take_pose(job);
  ASSERT_FALSE(pose.has_value());
  EXPECT_EQ(pose.error().kind, ErrorKind::kCancelled) << pose.error().line();
}

}  // namespace
}  // namespace dubsar
