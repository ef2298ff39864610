// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stop_token>
#include <thread>

#include "build_paths.h"
#include "drivers/loader.h"
#include "drivers/plugin.h"
#include "formats/grid_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wrong_spacing.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Names : public ProfileSink {
 public:
  explicit Names(int stop_after = 1 << 30) : stop_after_(stop_after) {}
  bool begin(const ScanInfo& info) override {
    last = info;
    return true;
  }
  bool profile(const Profile& profile) override {
    x.insert(x.end(), profile.x.begin(), profile.x.end());
    return ++rows < stop_after_;
  }
  void end(const ScanTally& /*tally*/) override {}
  void remark(const std::string& text) override { remarks.push_back(text); }

  std::vector<std::string> remarks;
  ScanInfo last;
  std::vector<float> x;
  int rows = 0;

 private:
  int stop_after_;
};

RangeGrid small_grid(int rows, int cols) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] = 0.25F * static_cast<float>(grid.col_of(i));
    grid.y[i] = 0.25F * static_cast<float>(grid.row_of(i));
    grid.valid[i] = 1;
  }
  return grid;
}

class ReplayTest : public testing::Test {
 protected:
  Result<Device> open(const fs::path& path,
                      const std::vector<std::pair<std::string, std::string>>& options = {}) {
    return (*registry_.find("replay"))->open(path.string(), options);
  }
  DriverRegistry registry_{{fs::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
  test::TemporaryFolder folder_;
};

constexpr const char* kPoints =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nend_header\n1 2 3\n4 5 6\n7 8 9\n";

TEST_F(ReplayTest, PlaysAFolderInNameOrderAndSkipsWhatIsNoScan) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(5, 4)));
  ASSERT_TRUE(write_grid_file(folder_.path() / "a.grid", small_grid(3, 2)));
  std::ofstream(folder_.path() / "c.ply") << kPoints;
  std::ofstream(folder_.path() / "scans.conf") << "camera 0 0 0\n";
  fs::create_directory(folder_.path() / "deeper");
  ASSERT_TRUE(write_grid_file(folder_.path() / "deeper/0.grid", small_grid(9, 9)));

  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device) << device.error().line();
  const auto capabilities = device->capabilities();
  ASSERT_TRUE(capabilities);
  EXPECT_TRUE(capabilities->finite);
  EXPECT_FALSE(capabilities->can_place);
  EXPECT_FALSE(capabilities->rig);
  EXPECT_EQ(capabilities->scan_count, 3);

  Names first;
  ASSERT_EQ(device->scan(first).value(), ScanOutcome::kScanned);
  EXPECT_EQ(first.last.source, "a.grid");
  EXPECT_EQ(first.rows, 3);
  EXPECT_EQ(first.last.expected_rows, 3);
  EXPECT_NEAR(first.last.spacing_mm, 0.25, 1e-6);
  Names second;
  ASSERT_EQ(device->scan(second).value(), ScanOutcome::kScanned);
  EXPECT_EQ(second.last.source, "b.grid");
  EXPECT_EQ(second.rows, 5);
  Names third;
  ASSERT_EQ(device->scan(third).value(), ScanOutcome::kScanned);
  EXPECT_FALSE(third.last.organised);
  EXPECT_THAT(third.x, ElementsAre(1, 4, 7));
  Names after;
  EXPECT_EQ(device->scan(after).value(), ScanOutcome::kExhausted);
}

TEST_F(ReplayTest, WhatReadingRemarksIsToldWithItsScan) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "a.grid", small_grid(3, 2)));
  std::ofstream(folder_.path() / "b.ply") << test::ply_of_wrong_spacing();
  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device);
  Names right;
  ASSERT_TRUE(device->scan(right));
  EXPECT_THAT(right.remarks, testing::IsEmpty());
  Names wrong;
  testing::internal::CaptureStderr();
  ASSERT_TRUE(device->scan(wrong));
  EXPECT_THAT(wrong.remarks, ElementsAre(HasSubstr("its header says a spacing of 2.5 mm")));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "who is told says it";
}

/// A program of before there were remarks lends a shorter sink.
TEST_F(ReplayTest, AnOlderProgramFindsRemarksInItsLog) {
  int called = 0;
  dubsar_sink sink{};
  sink.user = &called;
  sink.remark = [](void* user, const char* /*text*/) { ++*static_cast<int*>(user); };
  sink.struct_size = offsetof(dubsar_sink, remark);
  EXPECT_FALSE(plugin::remark(sink, "the header is wrong"));
  sink.struct_size = sizeof sink;
  EXPECT_TRUE(plugin::remark(sink, "the header is wrong"));
  EXPECT_EQ(called, 1);
  sink.remark = nullptr;
  EXPECT_FALSE(plugin::remark(sink, "the header is wrong"));
}

/// While it is read no sink is asked whether to go on: Ctrl-C would be answered only minutes later.
TEST_F(ReplayTest, StopEndsTheReadingOfALargeFileWhichIsThenStillToBeRead) {
  {
    std::ofstream file(folder_.path() / "a.xyz");
    std::string lines;
    for (int k = 0; k < 20000; ++k) {
      lines += std::to_string(0.01 * k) + " " + std::to_string(0.02 * (k % 90)) + " 1.25\n";
    }
    for (int k = 0; k < 100; ++k) {
      file << lines;  // 2 million points: most of a second, a stop comes every millisecond
    }
  }
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(3, 2)));
  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->can_stop());
  EXPECT_TRUE(device->stop()) << "stopping what does not read is no error";
  Names none;
  {
    const std::jthread stopper([&](const std::stop_token& done) {
      while (!done.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        EXPECT_TRUE(device->stop());
      }
    });
    const Result<ScanOutcome> stopped = device->scan(none);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled) << stopped.error().line();
  }
  EXPECT_EQ(none.rows, 0);
  Names first;
  ASSERT_EQ(device->scan(first).value(), ScanOutcome::kScanned);
  EXPECT_EQ(first.last.source, "a.xyz");
  Names second;
  ASSERT_EQ(device->scan(second).value(), ScanOutcome::kScanned);
  EXPECT_EQ(second.last.source, "b.grid");
}

TEST_F(ReplayTest, ReadsEachFileOnlyWhenItsTurnHasCome) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "a.grid", small_grid(3, 2)));
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(3, 2)));
  ASSERT_TRUE(write_grid_file(folder_.path() / "c.grid", small_grid(4, 2)));
  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device);
  Names sink;
  ASSERT_TRUE(device->scan(sink));
  fs::resize_file(folder_.path() / "b.grid", 40);
  const auto broken = device->scan(sink);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(broken.error().line(), HasSubstr("b.grid"));
  ASSERT_EQ(device->scan(sink).value(), ScanOutcome::kScanned);
  EXPECT_EQ(sink.last.source, "c.grid");
}

TEST_F(ReplayTest, TheUnitOptionScales) {
  std::ofstream(folder_.path() / "c.ply") << kPoints;
  for (const auto& [unit, x] : {std::pair("m", 1000.0F), std::pair("mm", 1.0F), std::pair("um", 0.001F),
                                std::pair("cm", 10.0F), std::pair("in", 25.4F)}) {
    Result<Device> device = open(folder_.path() / "c.ply", {{"unit", unit}});
    ASSERT_TRUE(device);
    Names sink;
    ASSERT_TRUE(device->scan(sink));
    EXPECT_FLOAT_EQ(sink.x[0], x);
  }
  EXPECT_THAT(open(folder_.path(), {{"unit", "inch"}}).error().line(), HasSubstr("m, cm, mm, um or in"));
  EXPECT_FALSE(open(folder_.path(), {{"rate", "fast"}}));
  EXPECT_FALSE(open(folder_.path(), {{"rate", "-3"}}));
}

TEST_F(ReplayTest, AFolderAboveTheScansSaysWhichToName) {
  const auto line = [&] { return open(folder_.path()).error().line(); };
  fs::create_directory(folder_.path() / "pictures");
  std::ofstream(folder_.path() / "pictures/1.jpg") << "no scan";
  EXPECT_THAT(line(), HasSubstr("holds no files, and of its subfolders (1) none holds scans; name a folder"));
  for (const char* name : {"b", "a", ".hidden"}) {
    fs::create_directory(folder_.path() / name);
    ASSERT_TRUE(write_grid_file(folder_.path() / name / "0.grid", small_grid(3, 2)));
  }
  EXPECT_THAT(line(), HasSubstr("of its subfolders (3) these hold scans: a, b; name one of these"));
  std::ofstream(folder_.path() / "readme.txt") << "Nothing but words here.\n";
  EXPECT_THAT(line(), HasSubstr("none of the 1 files in the folder is a scan, but of its subfolders (3)"));
}

TEST_F(ReplayTest, WhatCannotBeReadAmongOthersIsAnErrorOfItsOwn) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(3, 2)));
  fs::copy_file(folder_.path() / "b.grid", folder_.path() / "a.grid");
  std::fstream(folder_.path() / "a.grid", std::ios::in | std::ios::out | std::ios::binary) << 'x';
  std::ofstream(folder_.path() / "c.ptx");
  fs::create_symlink("gone.ply", folder_.path() / "d.ply");
  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device) << device.error().line();
  Names sink;
  const auto refused = [&](const char* line) {
    const auto outcome = device->scan(sink);
    ASSERT_FALSE(outcome) << line;
    EXPECT_EQ(outcome.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(outcome.error().line(), HasSubstr(line));
  };
  refused("a.grid: not a grid file of Dubsar (its first bytes are others)");
  ASSERT_EQ(device->scan(sink).value(), ScanOutcome::kScanned);
  EXPECT_EQ(sink.last.source, "b.grid");
  refused("c.ptx: the file is empty; copy or export it again");
  refused("d.ply: a link to a file that is not there; copy the file itself here");
  EXPECT_EQ(device->scan(sink).value(), ScanOutcome::kExhausted);
}

TEST_F(ReplayTest, ATextOfFewPointsBesideScansIsPassedOverAndSaid) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(3, 2)));
  std::ofstream(folder_.path() / "pose.txt") << "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n";
  testing::internal::CaptureStderr();
  Result<Device> device = open(folder_.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("hardly a scan: pose.txt;"));
  ASSERT_TRUE(device);
  EXPECT_EQ(device->capabilities()->scan_count, 1);
  fs::remove(folder_.path() / "b.grid");
  EXPECT_THAT(
      open(folder_.path()).error().line(),
      HasSubstr("none of the 1 files in the folder is a scan; name a file by itself if it is a scan of"));
  Names named;
  EXPECT_TRUE(open(folder_.path() / "pose.txt")->scan(named)) << "named itself it is read";
}

TEST_F(ReplayTest, AFolderOfTablesOrArchivesSaysWhatToDo) {
  std::ofstream(folder_.path() / "a.csv") << "1,2,3\n";
  EXPECT_THAT(open(folder_.path()).error().line(),
              HasSubstr("; rename .csv to .xyz where the lines are points"));
  std::ofstream(folder_.path() / "b.ply.gz") << "\x1f\x8b";
  EXPECT_THAT(open(folder_.path()).error().line(),
              HasSubstr("; unpack the packed files, rename .csv to .xyz"));
}

TEST_F(ReplayTest, AFolderWithoutScansIsOneClearLine) {
  const auto empty = open(folder_.path());
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(empty.error().line(), HasSubstr("empty"));
  std::ofstream(folder_.path() / "readme.txt") << "Nothing but words here.\n";
  EXPECT_THAT(open(folder_.path()).error().line(), HasSubstr("none of the 1 files"));
  EXPECT_THAT(open(folder_.path() / "nowhere").error().line(), HasSubstr("no such file"));
  EXPECT_EQ(open("").error().kind, ErrorKind::kUsage);
}

TEST_F(ReplayTest, CancelsInMidScanAndGoesOnWithTheNext) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "a.grid", small_grid(50, 4)));
  ASSERT_TRUE(write_grid_file(folder_.path() / "b.grid", small_grid(3, 2)));
  Result<Device> device = open(folder_.path());
  ASSERT_TRUE(device);
  Names sink(7);
  const auto outcome = device->scan(sink);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(sink.rows, 7);
  Names next;
  EXPECT_EQ(device->scan(next).value(), ScanOutcome::kScanned);
  EXPECT_EQ(next.last.source, "b.grid");
}

TEST_F(ReplayTest, ARateCanBeSetWhileOpen) {
  ASSERT_TRUE(write_grid_file(folder_.path() / "a.grid", small_grid(3, 2)));
  Result<Device> device = open(folder_.path(), {{"rate", "1000"}});
  ASSERT_TRUE(device);
  EXPECT_EQ(std::get<double>(device->get("rate").value()), 1000.0);
  EXPECT_TRUE(device->set("rate", 0.0));
  EXPECT_EQ(std::get<double>(device->get("rate").value()), 0.0);
  EXPECT_FALSE(device->set("rate", 0.5));
}

}  // namespace
}  // namespace dubsar
