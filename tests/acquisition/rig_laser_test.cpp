// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How a rig's scan ends: with its laser off, and what is said where that is not sure.
#include <gtest/gtest.h>

#include "acquisition/range_rig.h"
#include "acquisition/rig_device.h"
#include "tests/acquisition/rig_scan_fixture.h"

namespace dubsar {
namespace {

using test::Collect;
using RigLaser = test::RigScanFixture;

/// The rows are all there, and the operator reaches for the tablet.
TEST_F(RigLaser, ALaserThatCannotBePutOffIsToldAndTheRowsAreKept) {
  file.ambient = false;
  bench.burns_on = true;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  Collect sink;
  const Status burns = made->scan(sink);
  ASSERT_FALSE(burns.has_value());
  EXPECT_EQ(burns.error().kind, ErrorKind::kDevice);
  EXPECT_NE(burns.error().line().find("the laser may still be on"), std::string::npos);
  EXPECT_NE(burns.error().mend.find("pull its plug"), std::string::npos);
  EXPECT_EQ(sink.builder->grid().rows, file.rows);
  EXPECT_EQ(sink.tally.profiles_sent, static_cast<std::uint64_t>(file.rows));
  // Of a scan that failed both are told; of one that was stopped this one.
  bench.gone_after = static_cast<int>(bench.frames) + 4;
  Collect broken;
  const Status both = made->scan(broken);
  ASSERT_FALSE(both.has_value());
  EXPECT_NE(both.error().what.find("the camera is gone; the laser may still be on"), std::string::npos)
      << both.error().line();
  bench.gone_after = 1 << 30;
  Collect few;
  few.most_rows = 2;
  EXPECT_EQ(made->scan(few).error().kind, ErrorKind::kDevice);
}

/// Whoever looks through the camera is told, and does not end what did not begin.
TEST_F(RigLaser, AViewThatDoesNotBeginLeavesTheLaserOff) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  bench.lights_unsaid = true;
  const Status unsaid = made->start_view();
  ASSERT_FALSE(unsaid.has_value());
  EXPECT_NE(unsaid.error().what.find("does not answer"), std::string::npos) << unsaid.error().line();
  EXPECT_EQ(unsaid.error().what.find("laser may"), std::string::npos) << unsaid.error().line();
  EXPECT_EQ(bench.laser, 0);
  bench.burns_on = true;
  const Status burns = made->start_view();
  ASSERT_FALSE(burns.has_value());
  EXPECT_NE(burns.error().what.find("the laser may still be on"), std::string::npos) << burns.error().line();
}

TEST_F(RigLaser, AFailureLeavesTheRowsAndTheLaserOff) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  bench.gone_after = 9;
  Collect sink;
  const Status unplugged = made->scan(sink);
  ASSERT_FALSE(unplugged.has_value());
  EXPECT_EQ(unplugged.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(sink.builder->grid().rows, 4);
  EXPECT_EQ(sink.tally.profiles_sent, 4U);
  EXPECT_EQ(bench.laser, 0);
  // Plugged in again, it goes on.
  bench.gone_after = 1 << 30;
  Collect again;
  EXPECT_TRUE(made->scan(again).has_value());
  // A stage that stands still.
  bench.stuck = true;
  Collect stuck;
  const Status blocked = made->scan(stuck);
  ASSERT_FALSE(blocked.has_value());
  EXPECT_NE(blocked.error().what.find("not where it was sent: at 0.5 mm, not -0.5 mm"), std::string::npos);
  EXPECT_EQ(bench.laser, 0);
}

TEST_F(RigLaser, AnEmergencyStopIsTheStagesAndKeepsTheRows) {
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value());
  Device device = device_of(std::move(*made), "rig:a.toml");
  struct Halts : Collect {
    explicit Halts(Device& one) : device(one) {}
    bool profile(const Profile& profile) override {
      if (profile.row == 3) {
        EXPECT_TRUE(device.emergency_stop());
      }
      return Collect::profile(profile);
    }
    Device& device;
  } sink(device);
  const Result<ScanOutcome> halted = device.scan(sink);
  ASSERT_FALSE(halted.has_value());
  EXPECT_EQ(halted.error().kind, ErrorKind::kCancelled);
  EXPECT_GE(sink.builder->grid().rows, 4);
  EXPECT_LT(sink.builder->grid().rows, file.rows);
  EXPECT_NE(bench.asked.find('E'), std::string::npos);
  EXPECT_EQ(bench.laser, 0);
}

/// A camera may take seconds to start: whoever said stop meanwhile reaches in.
TEST_F(RigLaser, AStopWhileTheCameraStartsLeavesStageAndLaserAsTheyAre) {
  file.continuous = true;
  file.ambient = false;
  file.speed = 5;
  Result<RigScanner> made = make();
  ASSERT_TRUE(made.has_value()) << made.error().line();
  bench.when_started = [&made] { EXPECT_TRUE(made->stop().has_value()); };
  Collect sink;
  const Status stopped = made->scan(sink);
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled) << stopped.error().line();
  EXPECT_EQ(bench.position, 0);
  EXPECT_EQ(bench.asked.find('L'), std::string::npos) << bench.asked;
}

/// A range camera that is unplugged as soon as it is asked for profiles.
Device gone_range_camera() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = plugin::empty_driver();
    out.close = [](dubsar_device*) {};
    out.capabilities = [](dubsar_device*, dubsar_capabilities* to, dubsar_error*) -> std::int32_t {
      dubsar_capabilities c{};
      c.struct_size = sizeof c;
      plugin::lend(to, c);
      return DUBSAR_OK;
    };
    out.scan = [](dubsar_device*, const dubsar_sink*, dubsar_error* error) -> std::int32_t {
      return plugin::report(error, DUBSAR_DEVICE, "the camera is gone", "bench", "plug it in");
    };
    out.stop = [](dubsar_device*, dubsar_error* error) -> std::int32_t {
      return plugin::report(error, DUBSAR_DEVICE, "the camera does not answer", "bench", "plug it in");
    };
    return out;
  }();
  static int any = 0;
  return {&driver, reinterpret_cast<dubsar_device*>(&any), "bench_range:"};
}

/// GRBL puts a laser off in its turn, behind the move that still runs: for so long it would burn on.
TEST_F(RigLaser, ARangeCameraThatFailsEndsTheMotionBeforeTheLaserIsPutOff) {
  file.motion = RigMotion{};
  file.speed = 5;
  Result<RangeRig> made = RangeRig::make(file, gone_range_camera(), test::stage_of(bench), "rig.toml");
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Collect sink;
  EXPECT_EQ(made->scan(sink).error().kind, ErrorKind::kDevice);
  EXPECT_EQ(bench.asked, "LSD");
}

/// The stage obeys; the camera may have a laser of its own.
TEST_F(RigLaser, AStopThatARangeCameraDoesNotObeyIsTold) {
  file.motion = RigMotion{};
  file.speed = 5;
  Result<RangeRig> made = RangeRig::make(file, gone_range_camera(), test::stage_of(bench), "rig.toml");
  ASSERT_TRUE(made.has_value()) << made.error().line();
  for (const Status& said : {made->stop(), made->halt()}) {
    ASSERT_FALSE(said.has_value());
    EXPECT_EQ(said.error().what, "the camera does not answer");
  }
  EXPECT_EQ(bench.asked, "SE");
}

TEST_F(RigLaser, ALaserOfARangeCameraThatCannotBePutOffIsTold) {
  file.motion = RigMotion{};
  file.speed = 5;
  bench.burns_on = true;
  Result<RangeRig> made = RangeRig::make(file, gone_range_camera(), test::stage_of(bench), "rig.toml");
  ASSERT_TRUE(made.has_value()) << made.error().line();
  Collect sink;
  const Status failed = made->scan(sink);
  EXPECT_NE(failed.error().what.find("the camera is gone; the laser may still be on"), std::string::npos)
      << failed.error().line();
}

}  // namespace
}  // namespace dubsar
