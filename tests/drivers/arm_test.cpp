// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the driver interface says about arms, limits and stopping, on the simulated station and on a driver of
// before there were any.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <future>

#include "build_paths.h"
#include "core/keep_out.h"
#include "core/units.h"
#include "drivers/device.h"
#include "drivers/loader.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

const std::filesystem::path kLibraries = std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar";

class NominalPoses : public ProfileSink {
 public:
  bool begin(const ScanInfo& info) override {
    poses.push_back(info.nominal.value_or(NominalPose{}).tablet_from_scanner);
    return false;  // the header is enough
  }
  bool profile(const Profile& /*profile*/) override { return false; }
  void end(const ScanTally& /*tally*/) override {}
  std::vector<RigidTransform> poses;
};

class Arm : public testing::Test {
 protected:
  using Options = std::vector<std::pair<std::string, std::string>>;
  Device open(Options options) {
    options.insert(options.end(), {{"size", "24x20x10"}, {"spacing", "1"}});
    return (*registry_.find("sim"))->open("", options).value();
  }
  static Placement at(double bearing_deg, double tilt_deg, double roll_deg = 0) {
    Placement placement;
    placement.free_pose =
        stage_from_scanner(rad_from_deg(bearing_deg), rad_from_deg(tilt_deg), Eigen::Vector3d::Zero());
    placement.free_pose->rotation *=
        Eigen::AngleAxisd(rad_from_deg(roll_deg), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    placement.free_pose->translation_mm = {1, -2, 6};
    return placement;
  }
  static RigidTransform nominal(Device& device) {
    NominalPoses sink;
    [[maybe_unused]] const auto cancelled = device.scan(sink);
    return sink.poses.at(0);
  }
  DriverRegistry registry_{{kLibraries / "drivers"}};
};

TEST_F(Arm, GoesWhereItIsAskedTo) {
  Device device = open({{"motion", "robot"}});
  const DeviceCapabilities can = device.capabilities().value();
  ASSERT_TRUE(can.rig && can.rig->robot && can.rig->head);
  EXPECT_FALSE(can.rig->has_turntable);
  EXPECT_NEAR(can.rig->tilt_max_rad, rad_from_deg(70), 1e-9);
  const std::vector<Placement> stops{at(0, 30), at(140, 60, 90), at(-70, 10, 200)};
  std::vector<RigidTransform> said;
  for (const Placement& stop : stops) {
    const Status placed = device.place(stop);
    ASSERT_TRUE(placed) << placed.error().line();
    said.push_back(nominal(device));
  }
  for (std::size_t k = 1; k < stops.size(); ++k) {
    const RigidTransform asked = stops[0].free_pose->inverse() * *stops[k].free_pose;
    const RigidTransform got = said[0].inverse() * said[k];
    EXPECT_LT((asked.rotation - got.rotation).norm(), 1e-9);
    EXPECT_LT((asked.translation_mm - got.translation_mm).norm(), 1e-9);
  }
}

TEST_F(Arm, RefusesBeforeItMoves) {
  Device device = open({{"motion", "robot"}});
  ASSERT_TRUE(device.place(at(0, 20)));
  const RigidTransform before = nominal(device);
  Placement into_the_table = at(0, 70, 180);  // the camera's side down
  Placement too_low = at(0, 0);
  too_low.free_pose->translation_mm.z() = -140;
  Placement far = at(0, 0);
  far.free_pose->translation_mm.x() = 2000;
  Placement turned = at(0, 10);
  turned.turntable_rad = 1;
  for (const auto& [placement, says] :
       {std::pair{into_the_table, "would touch the support"}, std::pair{too_low, "stand-off"},
        std::pair{far, "reach"}, std::pair{at(0, 75), "tilt 75.00"}, std::pair{turned, "no turntable"},
        std::pair{Placement{0.5, 0.2, std::nullopt}, "neither turntable nor tilt"}}) {
    const Status placed = device.place(placement);
    ASSERT_FALSE(placed) << says;
    EXPECT_EQ(placed.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(placed.error().line(), HasSubstr(says));
  }
  EXPECT_EQ(nominal(device).row_major(), before.row_major());
  EXPECT_FALSE(open({}).place(at(0, 20)));  // a turntable is no arm
}

TEST_F(Arm, AMoveCanBeStoppedFromAnotherThread) {
  Device device = open({{"motion", "robot"}, {"move_time", "500"}});
  ASSERT_TRUE(device.can_stop());
  const RigidTransform before = nominal(device);
  std::future<Status> moving = std::async(std::launch::async, [&] { return device.place(at(90, 50)); });
  while (moving.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
    ASSERT_TRUE(device.stop());
  }
  const Status moved = moving.get();
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().kind, ErrorKind::kCancelled);
  // It stands where it came to, and knows it: hardly off the start.
  EXPECT_LT((before.inverse() * nominal(device)).angle_rad(), rad_from_deg(30));
}

TEST_F(Arm, AMotorThatFailsIsADeviceError) {
  Device device = open({{"fail_move_at", "1"}});
  ASSERT_TRUE(device.place({0.5, 0.25, std::nullopt}));
  const Status failed = device.place({1.0, 0.5, std::nullopt});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(failed.error().line(), HasSubstr("sim-1: a motor does not answer"));
  EXPECT_TRUE(device.place({1.0, 0.5, std::nullopt}));
}

TEST_F(Arm, ADriverOfBeforeArmsStillWorks) {
  const DriverRegistry registry({kLibraries / "test_drivers/old"});
  Device device = (*registry.find("old"))->open("", {}).value();
  const DeviceCapabilities can = device.capabilities().value();
  ASSERT_TRUE(can.rig);
  EXPECT_FALSE(can.rig->robot || can.rig->head);
  EXPECT_TRUE(can.rig->turns_fully());
  EXPECT_FALSE(can.rig->hand_turns);
  EXPECT_TRUE(device.place({0.5, 0, std::nullopt}));
  EXPECT_FALSE(device.place(at(0, 0)));
  EXPECT_FALSE(device.can_stop());
  EXPECT_TRUE(device.stop());  // which does nothing
}

TEST_F(Arm, BadDaysAreSaidPlainly) {
  for (const auto& [key, value] : Options{{"motion", "crane"},
                                          {"intrude", "foot@1"},
                                          {"intrude", "hand"},
                                          {"intrude", "hand@3-1"},
                                          {"intrude", "hand@x"},
                                          {"intrude", "grip@1-9/0"},
                                          {"swap_at", "-1"},
                                          {"stop_at", "1.5"},
                                          {"move_time", "nan"}}) {
    const auto opened = (*registry_.find("sim"))->open("", {{key, value}});
    ASSERT_FALSE(opened) << key << value;
    EXPECT_EQ(opened.error().kind, ErrorKind::kUsage) << opened.error().line();
  }
}

}  // namespace
}  // namespace dubsar
