// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "build_paths.h"
#include "drivers/loader.h"
#include "formats/rig_json.h"

namespace dubsar {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

class Recorder : public ProfileSink {
 public:
  explicit Recorder(int stop_after = 1 << 30) : stop_after_(stop_after) {}
  bool begin(const ScanInfo& info) override {
    infos.push_back(info);
    return stop_after_ > 0;
  }
  bool profile(const Profile& profile) override {
    rows.push_back(profile.row);
    return static_cast<int>(rows.size()) < stop_after_;
  }
  void end(const ScanTally& tally) override { tallies.push_back(tally); }

  std::vector<ScanInfo> infos;
  std::vector<std::int64_t> rows;
  std::vector<ScanTally> tallies;

 private:
  int stop_after_;
};

class DeviceTest : public testing::Test {
 protected:
  Device open(const std::string& mode) {
    return (*registry_.find("odd"))->open("1", {{"mode", mode}}).value();
  }
  DriverRegistry registry_{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/test_drivers/good"}};
};

TEST_F(DeviceTest, StreamsScansUntilTheSourceIsExhausted) {
  Device device = open("good");
  for (int scan = 0; scan < 2; ++scan) {
    Recorder sink;
    const auto outcome = device.scan(sink);
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(*outcome, ScanOutcome::kScanned);
    ASSERT_EQ(sink.infos.size(), 1U);
    EXPECT_EQ(sink.infos[0].cols, 8);
    EXPECT_EQ(sink.infos[0].device, "odd 0815");
    EXPECT_EQ(sink.infos[0].source, "odd scan");
    EXPECT_THAT(sink.rows, testing::ElementsAre(0, 1, 2, 3, 4, 5));
    ASSERT_EQ(sink.tallies.size(), 1U);
    EXPECT_EQ(sink.tallies[0].profiles_sent, 6U);
  }
  Recorder sink;
  EXPECT_EQ(device.scan(sink).value(), ScanOutcome::kExhausted);
  EXPECT_TRUE(sink.infos.empty());
}

TEST_F(DeviceTest, ANameOfMegabytesIsCutToTheLengthOfAPath) {
  Recorder sink;
  ASSERT_TRUE(open("longwinded").scan(sink));
  EXPECT_EQ(sink.infos.at(0).device, std::string(4096, 'n'));
}

TEST_F(DeviceTest, TellsTheRig) {
  const auto capabilities = open("good").capabilities();
  ASSERT_TRUE(capabilities);
  EXPECT_TRUE(capabilities->finite);
  EXPECT_TRUE(capabilities->can_place);
  EXPECT_EQ(capabilities->scan_count, 2);
  ASSERT_TRUE(capabilities->rig);
  EXPECT_EQ(capabilities->rig->name, "odd rig");
  EXPECT_TRUE(capabilities->rig->has_turntable);
  EXPECT_FALSE(capabilities->rig->hand_turns);
  EXPECT_DOUBLE_EQ(capabilities->rig->tilt_max_rad, 1.0);
  EXPECT_FALSE(capabilities->rig->calibration_age_days);
  ASSERT_TRUE(capabilities->rig->view.laser_mm);
  EXPECT_DOUBLE_EQ(capabilities->rig->view.laser_mm->z(), 200);
  EXPECT_FALSE(capabilities->rig->view.camera_mm);
}

/// What is kept of it in a session could not be read again.
TEST_F(DeviceTest, ATiltOutOfAllReasonIsAFaultOfTheDriver) {
  const auto capabilities = open("twisted").capabilities();
  ASSERT_FALSE(capabilities);
  EXPECT_THAT(capabilities.error().line(), HasSubstr("told a range of its tilt that is none"));
}

/// Likewise: the refusals of drivers and of the reader have the same limits.
TEST_F(DeviceTest, ARigOutOfAllReasonIsAFaultOfTheDriver) {
  constexpr std::pair<const char*, const char*> kBeyond[] = {
      {"coarse", "odd:1: the driver told a rig with a spacing of 2000 mm, beyond 1000 mm"},
      {"deep", "the driver told a rig with a depth range of 2000000 mm, beyond 1000000 mm"},
      {"high", "the driver told a rig with a support height of 2000000 mm, beyond 1000000 mm"},
      {"ancient", "the driver told a rig whose calibration has an age of 2000000 days, beyond 1000000 days"}};
  for (const auto& [mode, said] : kBeyond) {
    const auto capabilities = open(mode).capabilities();
    ASSERT_FALSE(capabilities) << mode;
    EXPECT_THAT(capabilities.error().line(), HasSubstr(said));
  }
  for (const char* mode : {"good", "largest"}) {
    const auto capabilities = open(mode).capabilities();
    ASSERT_TRUE(capabilities) << capabilities.error().line();
    const auto read = parse_rig(rig_to_json(*capabilities->rig), "session");
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(read->spacing_mm, capabilities->rig->spacing_mm);
    EXPECT_EQ(read->depth_range_mm, capabilities->rig->depth_range_mm);
  }
}

TEST_F(DeviceTest, PlacesWithinItsReachOnly) {
  Device device = open("good");
  ASSERT_TRUE(device.place({.turntable_rad = 0.5, .tilt_rad = 0.25, .hand_turn = {}}));
  Recorder sink;
  ASSERT_TRUE(device.scan(sink));
  ASSERT_TRUE(sink.infos[0].nominal);
  EXPECT_NEAR(sink.infos[0].nominal->tablet_from_scanner.angle_rad(), 0.5, 1e-12);

  const Status tilted = device.place({.turntable_rad = 0, .tilt_rad = 1.5, .hand_turn = {}});
  ASSERT_FALSE(tilted);
  EXPECT_EQ(tilted.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(tilted.error().line(), HasSubstr("57.30 deg"));
  EXPECT_FALSE(device.place({.turntable_rad = 0, .tilt_rad = 0, .hand_turn = RigidTransform{}}));
}

TEST_F(DeviceTest, ANominalPoseColumnByColumnIsAFaultOfTheDriver) {
  Recorder rows;
  ASSERT_TRUE(open("good").scan(rows));
  ASSERT_TRUE(rows.infos[0].nominal);
  EXPECT_EQ(rows.infos[0].nominal->tablet_from_scanner.translation_mm, Eigen::Vector3d(5, 0, 0));

  Recorder columns;
  const auto outcome = open("columns").scan(columns);
  ASSERT_FALSE(outcome) << "its translation would be lost";
  EXPECT_THAT(outcome.error().line(), HasSubstr("told a nominal pose that is no rigid motion"));
  EXPECT_THAT(outcome.error().line(), HasSubstr("row by row with the last row 0 0 0 1"));
  EXPECT_TRUE(columns.infos.empty());
}

TEST_F(DeviceTest, SettingsAreCheckedAgainstWhatTheyTake) {
  Device device = open("good");
  ASSERT_EQ(device.settings().value().size(), 4U);
  EXPECT_TRUE(device.set("gain", 2.5));
  EXPECT_EQ(std::get<double>(device.get("gain").value()), 2.5);
  EXPECT_TRUE(device.set("average", std::int64_t{4}));
  EXPECT_EQ(std::get<std::int64_t>(device.get("average").value()), 4);
  EXPECT_TRUE(device.set("light", std::string("off")));
  EXPECT_EQ(std::get<std::string>(device.get("light").value()), "off");
  EXPECT_EQ(std::get<std::int64_t>(device.get("hours").value()), 1234);

  EXPECT_THAT(device.set("gain", 11.0).error().line(),
              HasSubstr("setting gain takes a number from 0 to 10 dB"));
  EXPECT_FALSE(device.set("gain", std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(device.set("gain", std::string("2.5")));
  EXPECT_THAT(device.set("average", std::int64_t{17}).error().line(),
              HasSubstr("a whole number from 1 to 16"));
  EXPECT_THAT(device.set("light", std::string("dim")).error().line(), HasSubstr("one of on, off"));
  EXPECT_THAT(device.set("hours", std::int64_t{0}).error().line(),
              EndsWith("no setting hours to change; it has gain, average, light"));
  EXPECT_THAT(device.get("colour").error().line(), EndsWith("it has gain, average, light, hours"));
  EXPECT_EQ(std::get<double>(device.get("gain").value()), 2.5);
}

TEST_F(DeviceTest, ASinkCancelsAtBeginAndInMidScan) {
  for (const int after : {0, 1, 100}) {
    Device device = open("forever");
    Recorder sink(after);
    const auto outcome = device.scan(sink);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(sink.rows.size(), static_cast<std::size_t>(after));
    EXPECT_EQ(sink.tallies.size(), 1U);
  }
}

TEST_F(DeviceTest, AFailureInMidScanIsToldAndTheNextScanRuns) {
  Device device = open("fail");
  Recorder sink;
  const auto outcome = device.scan(sink);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(outcome.error().line(), "odd:1: the cable was pulled");
  EXPECT_EQ(sink.rows.size(), 3U);
  EXPECT_EQ(sink.tallies.size(), 1U);
  Recorder second;
  EXPECT_EQ(device.scan(second).value(), ScanOutcome::kScanned);
}

TEST_F(DeviceTest, AFaultyDriverGivesAnErrorThatNamesIt) {
  for (const char* mode : {"silent", "cols", "late"}) {
    Device device = open(mode);
    Recorder sink;
    const auto outcome = device.scan(sink);
    ASSERT_FALSE(outcome) << mode;
    EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice) << mode;
    EXPECT_THAT(outcome.error().line(), HasSubstr("driver")) << mode;
    EXPECT_TRUE(sink.rows.empty()) << mode;
  }
}

}  // namespace
}  // namespace dubsar
