// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The example of docs/developers/add-a-driver.md keeps what that page asks of a driver.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "build_paths.h"
#include "drivers/device.h"
#include "drivers/loader.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

class Taker : public ProfileSink {
 public:
  explicit Taker(int rows_wanted = 1000) : rows_wanted_(rows_wanted) {}
  bool begin(const ScanInfo& info) override {
    cols = info.cols;
    spacing_mm = info.spacing_mm;
    return rows_wanted_ > 0;
  }
  bool profile(const Profile& /*profile*/) override { return ++rows < rows_wanted_; }
  void end(const ScanTally& /*tally*/) override { ++ends; }

  int cols = 0;
  double spacing_mm = 0;
  int rows = 0;
  int ends = 0;

 private:
  int rows_wanted_;
};

class PlateDriver : public testing::Test {
 protected:
  [[nodiscard]] Result<Device> open(const std::string& locator, const std::string& scans = "1") const {
    return (*registry_.find("plate"))->open(locator, {{"scans", scans}});
  }
  DriverRegistry registry_{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/test_drivers/example"}};
};

TEST_F(PlateDriver, ScansAsOftenAsItIsAskedToAndThenEnds) {
  Device device = open("1", "2").value();
  EXPECT_EQ(device.capabilities().value().rig.value().spacing_mm, 0.1);
  for (int k = 0; k < 2; ++k) {
    Taker taker;
    EXPECT_EQ(device.scan(taker).value(), ScanOutcome::kScanned);
    EXPECT_EQ(taker.cols, 301);
    EXPECT_EQ(taker.spacing_mm, 0.1);
    EXPECT_EQ(taker.rows, 201);
    EXPECT_EQ(taker.ends, 1);
  }
  Taker taker;
  EXPECT_EQ(device.scan(taker).value(), ScanOutcome::kExhausted);
  EXPECT_EQ(taker.ends, 0);
}

TEST_F(PlateDriver, EndsOnceWhereverItIsStopped) {
  Device device = open("1", "3").value();
  for (const int rows : {0, 1, 50}) {
    Taker taker(rows);
    const auto outcome = device.scan(taker);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(taker.rows, rows);
    EXPECT_EQ(taker.ends, 1);
  }
}

TEST_F(PlateDriver, RefusesWhatItIsNot) {
  EXPECT_THAT(open("2").error().line(), HasSubstr("there is no such plate; name plate:1"));
  for (const char* scans : {"0", "10", "two", "1.5", ""}) {
    EXPECT_THAT(open("1", scans).error().line(), HasSubstr("scans= is no number from 1 to 9")) << scans;
  }
}

}  // namespace
}  // namespace dubsar
