// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A rig of a simulated camera and stage behind the driver interface, scanned as any other device.
#include "acquisition/rig_scan.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "acquisition/camera_region.h"
#include "acquisition/exposure.h"
#include "acquisition/range_rig.h"
#include "acquisition/rig_device.h"
#include "tests/acquisition/rig_scan_fixture.h"

namespace dubsar {
namespace {

using test::Collect;
using RigScan = test::RigScanFixture;

TEST_F(RigScan, ScansAPlaneThroughTheDriverInterface) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Device device = device_of(std::move(*made), "rig:rig.toml");
  const Result<DeviceCapabilities> can = device.capabilities();
  ASSERT_TRUE(can.has_value()) << can.error().line();
  ASSERT_TRUE(can->rig.has_value());
  EXPECT_EQ(can->rig->name, "bench rig");
  EXPECT_EQ(can->serial, "SIM-CAMERA");
  EXPECT_NEAR(can->rig->field_x_mm, 6.25 - off_middle_mm(), 0.01);
  EXPECT_NEAR(can->rig->field_y_mm, 1.0, 1e-9);
  EXPECT_GT(can->rig->calibration_age_days.value_or(0), 100);
  // What shows a session later counts the days from the date in it.
  EXPECT_NE(can->rig->calibration.find(", made " + bench.truth.made_at), std::string::npos)
      << can->rig->calibration;
  Collect sink;
  const Result<ScanOutcome> outcome = device.scan(sink);
  ASSERT_TRUE(outcome.has_value()) << outcome.error().line();
  const RangeGrid grid = sink.builder->take();
  EXPECT_EQ(grid.rows, 11);
  EXPECT_EQ(grid.cols, 256);
  EXPECT_GT(grid.valid_count(), 2700U);
  double squares = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      squares += std::pow(static_cast<double>(grid.z[i]) - 0.5, 2);
    }
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(grid.valid_count())), 0.003);
  EXPECT_NEAR(static_cast<double>(grid.y[grid.index(10, 128)]), 0.5, 0.003);
  EXPECT_EQ(bench.laser, 0) << "off when it is done";
  EXPECT_EQ(bench.frames, 22U);
}

/// Real cameras are as fast as their region is low.
TEST_F(RigScan, APartOfTheCalibratedPictureGivesTheSamePoints) {
  file.stripe_method = "gaussian";  // which sees nothing but its column
  Collect whole;
  {
    Result<RigScanner> made = make();
    ASSERT_TRUE(made.has_value()) << made.error().line();
    ASSERT_TRUE(made->scan(whole).has_value());
  }
  bench.frames = 0;  // the same noise again
  bench.part = {{"width_px", 256}, {"height_px", 200}, {"offset_x_px", 0}, {"offset_y_px", 0}};
  file.region = PictureRegion{32, 60, 192, 90};
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  EXPECT_EQ(bench.part["offset_y_px"], 60);
  EXPECT_NEAR(made->rig().field_x_mm, 6.25 * 192 / 256 - off_middle_mm(), 0.01);
  EXPECT_LT(made->rig().depth_range_mm, 0.5 * bench.truth.depth_range_mm);
  Collect part;
  const Status scanned = made->scan(part);
  ASSERT_TRUE(scanned.has_value()) << scanned.error().line();
  const RangeGrid& all = whole.builder->grid();
  const RangeGrid& some = part.builder->grid();
  ASSERT_EQ(some.cols, 192);
  ASSERT_EQ(some.rows, all.rows);
  std::size_t both = 0;
  for (int row = 0; row < some.rows; ++row) {
    for (int col = 0; col < some.cols; ++col) {
      if (some.is_valid(row, col) && all.is_valid(row, col + 32)) {
        const Eigen::Vector3f apart = some.point(some.index(row, col)) - all.point(all.index(row, col + 32));
        ASSERT_LT(apart.norm(), 1e-4F) << row << " " << col;
        ++both;
      }
    }
  }
  EXPECT_GT(both, 0.9 * static_cast<double>(some.size()));
  // It is calibrated with all of it.
  Device camera = test::camera_of(bench);
  ASSERT_TRUE(put_whole_picture(camera, "rig.toml"));
  EXPECT_EQ(bench.part, (std::map<std::string, int>{
                            {"width_px", 256}, {"height_px", 200}, {"offset_x_px", 0}, {"offset_y_px", 0}}));
}

TEST_F(RigScan, APartThatCannotBeSentOrHoldsNotTheMiddleIsRefused) {
  file.region = PictureRegion{0, 60, 256, 90};
  EXPECT_NE(refusal().find("offset_x_px"), std::string::npos) << "a camera without that setting";
  bench.part = {{"width_px", 256}, {"height_px", 200}, {"offset_x_px", 0}, {"offset_y_px", 0}};
  file.region = PictureRegion{0, 120, 256, 81};
  EXPECT_NE(refusal().find("beyond the picture"), std::string::npos);
  file.region = PictureRegion{0, 0, 256, 64};
  EXPECT_NE(refusal().find("the middle of the measuring volume"), std::string::npos);
}

/// Its axis lies 20 mm behind the plane.
RigCalibration small_turntable() {
  sim::FrameRigOptions size;
  size.width = 256;
  size.height = 200;
  size.field_mm = 6.25;
  size.motion = MotionKind::kTurntable;
  return sim::frame_rig(size);
}

TEST_F(RigScan, OnATurntableTheSpacingIsThatOfTheClay) {
  bench.truth = small_turntable();
  file.turns = true;
  file.start = -0.1;
  file.step = 0.02;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Device device = device_of(std::move(*made), "rig:rig.toml");
  EXPECT_NEAR(device.capabilities()->rig->spacing_mm, 0.02 * 0.25 * bench.truth.depth_range_mm, 1e-9);
  Collect sink;
  ASSERT_TRUE(device.scan(sink).has_value());
  sink.builder->estimate_spacing();
  EXPECT_NEAR(sink.builder->grid().spacing_mm, 0.02 * 20, 0.04);
}

TEST_F(RigScan, OnATurntableAScanIsSeenFromTheMiddleOfItsTurn) {
  bench.truth = small_turntable();
  file.turns = true;
  file.start = 1.0;
  file.step = 0.01;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Device device = device_of(std::move(*made), "rig:rig.toml");
  Collect sink;
  ASSERT_TRUE(device.scan(sink).has_value());
  const double middle = file.start + 0.5 * file.step * (file.rows - 1);
  const RigidTransform scanner = bench.truth.scanner_from_camera();
  const RigidTransform there = scanner * bench.truth.motion.zero_from_camera(middle);
  const Eigen::Vector3d sight = there.rotation * (scanner.inverse() * Eigen::Vector3d(0, 0, 0)).normalized();
  for (const ScannerView& view : {sink.builder->grid().view, device.capabilities()->rig->view}) {
    EXPECT_LT((view.camera_mm.value() - there.translation_mm).norm(), 1e-6);
    EXPECT_LT((view.direction - sight).norm(), 1e-9);
  }
  file.step = 2.2 / (file.rows - 1);
  EXPECT_NE(refusal().find("turns the tablet by 126"), std::string::npos) << refusal();
}

TEST_F(RigScan, OfAMirrorTheSpacingGoesByItsDistanceFromTheClay) {
  sim::FrameRigOptions size;
  size.motion = MotionKind::kGalvanometer;
  const RigCalibration rig = sim::frame_rig(size);
  const double away_mm = (Eigen::Vector3d(0, 0, rig.working_distance_mm) - *rig.laser_source_mm).norm();
  EXPECT_NEAR(rig.row_spacing_mm(0.001), 0.001 * away_mm, 1e-9);
}

TEST_F(RigScan, IsLookedThroughWithTheLaserLitBetweenScans) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  Device device = device_of(std::move(*made), "rig:rig.toml");
  ASSERT_TRUE(device.capabilities()->yields_frames);
  EXPECT_TRUE(device.settings()->empty());
  ASSERT_TRUE(device.start_frames().has_value());
  EXPECT_GT(bench.laser, 0);
  {
    const Result<std::optional<Frame>> frame = device.next_frame(std::chrono::milliseconds(100));
    ASSERT_TRUE(frame && *frame) << frame.error().line();
    EXPECT_EQ((*frame)->width, static_cast<std::uint32_t>(bench.truth.camera.width));
    const GrayView view{(*frame)->pixels.data(), static_cast<int>((*frame)->width),
                        static_cast<int>((*frame)->height), (*frame)->stride_bytes};
    EXPECT_TRUE(judge_exposure(view).has_stripe);
  }
  // Its light is that of the rig's file, or none.
  ASSERT_TRUE(device.set_laser(0, 0).has_value());
  EXPECT_EQ(bench.laser, 0);
  ASSERT_TRUE(device.set_laser(0, 0.01).has_value());
  EXPECT_EQ(bench.laser, file.laser_power);
  ASSERT_TRUE(device.stop_frames().has_value());
  EXPECT_EQ(bench.laser, 0);
  Collect sink;
  EXPECT_TRUE(device.scan(sink).has_value());
}

TEST_F(RigScan, RefusesPartsThatDoNotFit) {
  bench.serial = "ANOTHER";
  EXPECT_NE(refusal().find("camera ANOTHER"), std::string::npos);
  bench.serial = "SIM-CAMERA";
  file.axis = 3;
  EXPECT_NE(refusal().find("no axis 3"), std::string::npos);
  file.axis = 0;
  bench.limit = 0.3;
  EXPECT_NE(refusal().find("from -0.5 mm to 0.5 mm leaves the axis' limits, -0.3 mm to 0.3 mm"),
            std::string::npos);
  bench.limit = 10;
  file.camera_settings = {{"exposure_us", "1500"}};
  EXPECT_FALSE(make().has_value());
  file.camera_settings.clear();
  bench.truth.has_motion = false;
  EXPECT_NE(refusal().find("stage"), std::string::npos);
  bench.truth.has_motion = true;
  Result<RigScanner> swapped =
      RigScanner::make(file, bench.truth, test::stage_of(bench), test::camera_of(bench), "rig.toml");
  ASSERT_FALSE(swapped.has_value());
  EXPECT_NE(swapped.error().what.find("no camera"), std::string::npos);
}

/// A screw's play would set row 0 apart that is come to from above, as from the last row of the scan before.
TEST_F(RigScan, ComesToItsFirstRowFromBelow) {
  file.rows = 3;
  file.ambient = false;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Collect sink;
  ASSERT_TRUE(made->scan(sink).has_value());
  ASSERT_EQ(bench.sent.size(), 4U);
  EXPECT_NEAR(bench.sent[0], -1.5, 1e-9);
  EXPECT_EQ(bench.sent[1], -0.5);
  // Where its limit leaves no room it goes straight there.
  bench.limit = 0.5;
  bench.sent.clear();
  Result<RigScanner> narrow = make();
  ASSERT_TRUE(narrow.has_value()) << narrow.error().line();
  Collect again;
  ASSERT_TRUE(narrow->scan(again).has_value());
  EXPECT_EQ(bench.sent[0], -0.5);
  EXPECT_EQ(bench.sent.size(), 3U);
}

/// Three steps of 0.1 mm are a rounding more than 0.3 mm.
TEST_F(RigScan, GoesToTheVeryEndOfItsAxis) {
  bench.limit = 0.3;
  file.start = 0;
  file.rows = 4;
  file.ambient = false;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Collect sink;
  const Status done = made->scan(sink);
  ASSERT_TRUE(done.has_value()) << done.error().line();
  EXPECT_EQ(sink.builder->grid().rows, 4);
  EXPECT_EQ(bench.position, 0.3);
}

/// A scan copied from the file of another rig: 40 degrees would be 0.7 mm, 3 mm would be 172 degrees.
TEST_F(RigScan, RefusesAScanInTheUnitOfAnotherKindOfStage) {
  file.turns = true;
  const Result<RigScanner> slide = make();
  ASSERT_FALSE(slide.has_value());
  EXPECT_EQ(slide.error().kind, ErrorKind::kBadInput);
  EXPECT_NE(slide.error().line().find("said in degrees"), std::string::npos) << slide.error().line();
  file.turns = false;
  for (const MotionKind kind : {MotionKind::kTurntable, MotionKind::kGalvanometer}) {
    sim::FrameRigOptions size;
    size.motion = kind;
    bench.truth = sim::frame_rig(size);
    bench.can_home = true;
    EXPECT_NE(refusal().find("said in millimetres"), std::string::npos) << refusal();
  }
  // And with a range camera, before anything is opened.
  file.motion = RigMotion{};
  file.speed = 5;
  EXPECT_TRUE(RangeRig::check(file, "rig.toml"));
  file.turns = true;
  EXPECT_EQ(RangeRig::check(file, "rig.toml").error().kind, ErrorKind::kBadInput);
}

TEST_F(RigScan, RefusesAMirrorThatHasNoZeroOfItsOwn) {
  sim::FrameRigOptions size;
  size.motion = MotionKind::kGalvanometer;
  bench.truth = sim::frame_rig(size);
  file.turns = true;
  file.step = 0.0001;
  file.start = -0.0005;
  EXPECT_NE(refusal().find("no reference switch"), std::string::npos) << refusal();
  bench.can_home = true;
  const Result<RigScanner> made = make();
  EXPECT_TRUE(made.has_value()) << made.error().line();
}

/// A camera's pool holds half a second of frames, of which all grow old while the stage moves.
TEST_F(RigScan, FramesFromBeforeTheMoveAreLetGoHoweverManyThereAre) {
  file.rows = 2;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  bench.stale = 40;
  Collect sink;
  const Status scanned = made->scan(sink);
  EXPECT_TRUE(scanned.has_value()) << scanned.error().line();
  EXPECT_EQ(bench.frames, 44U);
}

TEST_F(RigScan, RowsCloseTogetherWaitForEachOtherAndNoneIsKeptBack) {
  file.step = 0.025;
  file.rows = 9;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Collect sink;
  ASSERT_TRUE(made->scan(sink).has_value());
  const RangeGrid grid = sink.builder->take();
  ASSERT_EQ(grid.rows, 9);
  EXPECT_EQ(sink.tally.profiles_sent, 9U);
  double squares = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    squares += grid.valid[i] != 0 ? std::pow(static_cast<double>(grid.z[i]) - 0.5, 2) : 0;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(grid.valid_count())), 0.003);
  // The camera is unplugged behind the sixth row: six rows came.
  bench.frames = 0;
  bench.gone_after = 12;
  Collect broken;
  EXPECT_FALSE(made->scan(broken).has_value());
  EXPECT_EQ(broken.builder->grid().rows, 6);
  // Who wants no more gets no more.
  bench.frames = 0;
  bench.gone_after = 1 << 30;
  Collect few;
  few.most_rows = 2;
  const Status enough = made->scan(few);
  ASSERT_FALSE(enough.has_value());
  EXPECT_EQ(enough.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(few.builder->grid().rows, 2);
}

TEST_F(RigScan, CancelledBySinkAndRefusesAnotherRegion) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  Collect few;
  few.most_rows = 3;
  const Status cancelled = made->scan(few);
  ASSERT_FALSE(cancelled.has_value());
  EXPECT_EQ(cancelled.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(few.builder->grid().rows, 3);
  bench.cut = 8;
  Collect cut;
  const Status region = made->scan(cut);
  ASSERT_FALSE(region.has_value());
  EXPECT_NE(region.error().what.find("calibrated with"), std::string::npos);
}

}  // namespace
}  // namespace dubsar
