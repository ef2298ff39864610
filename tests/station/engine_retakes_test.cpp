// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that are to be taken again.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <future>
#include <optional>
#include <thread>
#include <vector>

#include "acquisition/session_store.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/endless_scanner.h"
#include "tests/station/support/running_engine.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::driven;
using test::RunningEngine;

// Whatever is said of a scan, it was driven to: planner and motors go on by that.
TEST(EngineCommands, AScanThatIsPutBackIsTakenAgainFromWhereItWasDrivenTo) {
  const test::TemporaryFolder folder;
  RunningEngine engine(driven(folder));
  ASSERT_TRUE(engine.waits(1));
  ASSERT_TRUE(engine.post(DropScan{0, "by mistake"}));
  ASSERT_TRUE(engine.post(RestoreScan{0}));
  ASSERT_TRUE(engine.post(ScanAgain{0}));
  ASSERT_TRUE(engine.says("scan 0 is put back"));
  ASSERT_TRUE(engine.waits(2)) << "it knows of no view to take again";
  const std::optional<NextView> next = engine.next();
  ASSERT_TRUE(next && next->placement);
  EXPECT_EQ(next->placement->turntable_rad, 0);
  EXPECT_EQ(next->placement->tilt_rad, 0);
  ASSERT_TRUE(engine.post(ScanNow{}));
  ASSERT_TRUE(engine.waits(3));
  ASSERT_TRUE(engine.post(Finish{}));
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
}

double apart_rad(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
}

/// A session that is conclusive, and stays so without its first scan: there is a copy of that.
void make_conclusive(const std::filesystem::path& session) {
  ASSERT_TRUE(test::scan_all_round(session));
  SessionStore store = SessionStore::open(session).value();
  const Result<RangeGrid> first = store.load_grid(0);
  ASSERT_TRUE(first && store.add_grid(*first));
}

/// The first scan of such a session: nothing but that word asks for one.
EngineOptions taking_again(const std::filesystem::path& session) {
  EngineOptions options;
  options.device = "sim:?seed=1&size=12x10x8&spacing=0.4&noise=0.02";
  options.session = session;
  options.automatic = options.paced = options.first_scan_waits = true;
  options.first_commands = {ScanAgain{0}};
  return options;
}

TEST(EngineCommands, AScanThatIsToBeTakenAgainIsLostNeitherBehindAnotherWordNorWhileAnotherIsUnderWay) {
  const test::TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(make_conclusive(folder.path() / "s"));
  RunningEngine engine(taking_again(folder.path() / "s"));
  ASSERT_TRUE(engine.waits(1));
  const std::optional<NextView> first = engine.next();
  ASSERT_TRUE(first && first->placement);
  ASSERT_TRUE(engine.post(LockScan{1}));
  ASSERT_TRUE(engine.waits(2)) << "the run has ended, and nothing was taken again";
  const std::optional<NextView> still = engine.next();
  ASSERT_TRUE(still && still->placement);
  EXPECT_LT(apart_rad(still->model_from_scanner, first->model_from_scanner), 1e-6);
  const std::vector<ScanPose> poses = engine.poses();
  const auto other = std::ranges::find(poses, 2, &ScanPose::id);
  ASSERT_TRUE(other != poses.end() && other->status == PoseStatus::kRegistered);
  // That scan is under way, and another is to be taken again.
  engine.hold_next_scan();
  ASSERT_TRUE(engine.post(ScanNow{}));
  ASSERT_TRUE(engine.holds());
  EXPECT_TRUE(engine.post(ScanAgain{2}));
  EXPECT_TRUE(engine.says("scan 2 is taken out"));
  EXPECT_TRUE(engine.plans(4)) << "of the session, of two words and of this one";
  engine.let_go();
  ASSERT_TRUE(engine.waits(3)) << "the run has ended, or goes elsewhere, and scan 2 was not taken again";
  const std::optional<NextView> next = engine.next();
  ASSERT_TRUE(next && next->placement);
  EXPECT_LT(apart_rad(next->model_from_scanner, other->model_from_scanner), 0.4);
  ASSERT_TRUE(engine.post(Finish{}));
  const Result<EngineResult>& result = engine.join();
  EXPECT_TRUE(result.has_value()) << result.error().line();
}

TEST(EngineCommands, AScannerThatNothingDrivesIsWaitedForWhereAScanIsToBeTakenAgain) {
  const test::TemporaryFolder folder;
  const auto session = folder.path() / "s";
  ASSERT_NO_FATAL_FAILURE(make_conclusive(session));
  std::filesystem::copy(session / "grids", folder.path() / "scans");
  EngineOptions options = taking_again(session);
  options.device = test::endless_scanner(folder.path() / "scans");
  RunningEngine engine(options);
  ASSERT_TRUE(engine.waits(1));
  ASSERT_TRUE(engine.post(LockScan{1}));
  ASSERT_TRUE(engine.plans(3)) << "of the session, and of two words";
  ASSERT_TRUE(engine.post(ScanNow{}));
  EXPECT_TRUE(engine.says("stored ")) << "the run has ended, and nothing was taken again";
  engine.post(Finish{});
  const Result<EngineResult>& result = engine.join();
  EXPECT_TRUE(result.has_value()) << result.error().line();
}

/// A window starts the next run for it.
TEST(EngineCommands, AScanIsNotTakenOutToBeTakenAgainWhereNoMoreAreTaken) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 2);
  std::promise<void> rests, said;
  Engine engine({"replay:" + scans.string(), folder.path() / "s", false, 0, std::nullopt},
                [&](const Event& event) {
                  if (std::holds_alternative<DeviceRests>(event)) {
                    rests.set_value();
                    said.get_future().wait();
                  }
                });
  JobContext job;
  std::optional<Result<EngineResult>> result;
  std::jthread runs([&] { result.emplace(engine.run(job)); });
  EXPECT_EQ(rests.get_future().wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_FALSE(engine.post(ScanAgain{0}));
  EXPECT_TRUE(engine.post(LockScan{0})) << "other words are heeded still";
  said.set_value();
  runs.join();
  ASSERT_TRUE(*result) << result->error().line();
  EXPECT_EQ((*result)->poses.size(), 2U);
}

}  // namespace
}  // namespace dubsar
