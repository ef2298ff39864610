// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator asks of the engine while it runs: done between two scans, stored, and followed by all
// stages.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <thread>

#include "acquisition/operator_log.h"
#include "formats/pins_json.h"
#include "station/engine.h"
#include "station/session_pins.h"
#include "station/tablet_record.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/running_engine.h"
#include "tests/station/support/two_fold_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::driven;
using test::RunningEngine;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Of several commands in a row the first's next step is not told as the one to press the key for.
TEST(EngineCommands, ThinksAllOfThemOverBeforeItWaitsAgain) {
  const test::TemporaryFolder folder;
  RunningEngine engine(driven(folder));
  ASSERT_TRUE(engine.waits(1));
  ASSERT_TRUE(engine.post(LockScan{0}));
  ASSERT_TRUE(engine.post(UnlockScan{0}));
  ASSERT_TRUE(engine.post(ScanAgain{0}));
  ASSERT_TRUE(engine.says("scan 0 is taken out"));
  ASSERT_TRUE(engine.waits(2));
  // The key is for the scan that is taken again from where it was taken, not for where the lock would go on.
  const std::optional<NextView> next = engine.next();
  ASSERT_TRUE(next && next->placement);
  EXPECT_EQ(next->placement->turntable_rad, 0);
  EXPECT_EQ(next->placement->tilt_rad, 0);
  ASSERT_TRUE(engine.post(ScanNow{}));
  ASSERT_TRUE(engine.says("stored 1\n"));
  ASSERT_TRUE(engine.waits(3));
  ASSERT_TRUE(engine.post(Finish{}));
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  EXPECT_EQ(engine.times_waited(), 3);
}

std::vector<int> ids_of(const std::vector<ScanPose>& poses) {
  std::vector<int> ids;
  for (const ScanPose& pose : poses) {
    ids.push_back(pose.id);
  }
  return ids;
}

/// The scans that were not taken out.
std::vector<int> standing_in(const SessionStore& store) {
  std::vector<int> ids;
  const auto stored = store.scans();
  for (const StoredScan& scan : *stored) {
    if (!scan.dropped) {
      ids.push_back(scan.id);
    }
  }
  return ids;
}

TEST(EngineCommands, DropRestoreAndLock) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 4);
  const auto session = folder.path() / "session";
  RunningEngine engine(scans, session, 120);
  ASSERT_TRUE(engine.says("placed 1"));
  ASSERT_TRUE(engine.post(DropScan{0, "hand in view"}));
  ASSERT_TRUE(engine.says("scan 0 is taken out"));
  ASSERT_TRUE(engine.post(LockScan{1}));
  ASSERT_TRUE(engine.says("scan 1 is locked"));
  ASSERT_TRUE(engine.post(LockScan{9}));
  ASSERT_TRUE(engine.says("there is no scan 9"));
  ASSERT_TRUE(engine.post(RestoreScan{1}));
  ASSERT_TRUE(engine.says("scan 1 was not taken out"));
  ASSERT_TRUE(engine.post(DropScan{}));
  ASSERT_TRUE(engine.post(RestoreScan{0}));
  ASSERT_TRUE(engine.says("scan 0 is put back"));
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  EXPECT_FALSE(engine.post(UnlockScan{1}));
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  const std::vector<int> standing = standing_in(*store);
  EXPECT_EQ(standing.size(), 3U);
  EXPECT_EQ(ids_of(result->poses), standing);
  EXPECT_EQ(result->red_map.scans.size(), 3U);
  for (const ScanPose& pose : result->poses) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
    EXPECT_EQ(pose.locked, pose.id == 1);
  }
  const auto log = read_operator_log(*store);
  ASSERT_TRUE(log.has_value());
  EXPECT_TRUE(log->word.locked.contains(1));
}

TEST(EngineCommands, AScanIsTakenOutBeforeItIsPlaced) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 4);
  for (const bool put_back : {false, true}) {
    // As fast as they can be read: the last is on disk long before it is placed.
    const auto session = folder.path() / (put_back ? "back" : "out");
    RunningEngine engine(scans, session, 1e6);
    ASSERT_TRUE(engine.says("stored 3"));
    const bool taken = engine.post(DropScan{3, "the wrong side"});
    if (taken && put_back) {
      engine.post(RestoreScan{3});
    }
    const Result<EngineResult>& result = engine.join();
    ASSERT_TRUE(result.has_value()) << result.error().line();
    const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
    ASSERT_TRUE(store.has_value());
    const std::vector<int> standing = standing_in(*store);
    EXPECT_EQ(ids_of(result->poses), standing) << (put_back ? "put back" : "out");
    EXPECT_EQ(result->red_map.scans.size(), standing.size());
  }
}

TEST(EngineCommands, AHintSettlesAScanAtOnce) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_two_fold_scans(folder.path() / "scans");
  // A third scan keeps the engine at work while the operator clicks.
  std::filesystem::copy_file(scans / "scan_0.ply", scans / "scan_2.ply");
  RunningEngine engine(scans, folder.path() / "session", 120);
  ASSERT_TRUE(engine.says("placed 1 unsure"));
  const Eigen::Vector3d p(14, -9, test::two_fold_surface()(14, -9));
  GivenHint given;
  given.hint.on = 0;
  given.hint.points = {{test::two_fold_pose(1).inverse() * p, p}};
  ASSERT_TRUE(engine.post(HintScan{1, given}));
  ASSERT_TRUE(engine.says("scan 1 has a hint"));
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  const ScanPose& pose = result->poses.at(1);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  EXPECT_LT((pose.model_from_scanner * given.hint.points[0].point_mm - p).norm(), 0.05);
}

TEST(EngineCommands, LabelsThatAreTakenBackAreNoPinsAnyMore) {
  const test::TemporaryFolder folder;
  EngineOptions options;
  options.device = "sim:?seed=1&size=12x10x8&spacing=0.4&noise=0.02";
  options.session = folder.path() / "session";
  options.automatic = options.paced = true;
  RunningEngine engine(options);
  ASSERT_TRUE(engine.waits(1));
  ASSERT_TRUE(engine.post(LabelPins{0, {{1, {3, 4, 5}}}, 1.5}));
  ASSERT_TRUE(engine.says("the pins of scan 0 are labelled\n"));
  ASSERT_TRUE(engine.post(LabelPins{0, {}, 1.5}));
  ASSERT_TRUE(engine.says("the pins of scan 0 have no labels by hand any more\n"));
  const std::string said = engine.said();
  EXPECT_THAT(said.substr(said.find("are labelled")), HasSubstr("\nno pins\n"));
  ASSERT_TRUE(engine.post(Finish{}));
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  const auto pins =
      session_pins(SessionStore::open(options.session, SessionStore::Access::kReadOnly).value());
  ASSERT_TRUE(pins);
  EXPECT_FALSE(pins->has_value());
}

/// It is on the disk, and was made ready as if it had none.
TEST(EngineCommands, PinsThatAreLabelledWhileAScanWaitsToBePlacedAreNoClayOfIt) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 2);
  std::promise<void> waits, labelled;
  std::atomic<double> tip_mm = -1;
  Engine engine({"replay:" + scans.string(), folder.path() / "s", false, 0, std::nullopt},
                [&](const Event& event) {
                  const auto* stored = std::get_if<ScanStored>(&event);
                  const auto* placed = std::get_if<ScanPlaced>(&event);
                  if (stored != nullptr && stored->id == 1) {
                    waits.set_value();
                  } else if (placed != nullptr && placed->pose.id == 0) {
                    labelled.get_future().wait();  // the other waits behind it
                  } else if (placed != nullptr) {
                    tip_mm = placed->measured->pin_tip_diameter_mm;
                  }
                });
  JobContext job;
  std::optional<Result<EngineResult>> result;
  std::jthread runs([&] { result.emplace(engine.run(job)); });
  EXPECT_EQ(waits.get_future().wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_TRUE(engine.post(LabelPins{0, {{1, {3, 4, 5}}}, 1.5}));
  labelled.set_value();
  runs.join();
  ASSERT_TRUE(*result) << result->error().line();
  EXPECT_EQ(tip_mm.load(), 1.5);
}

TEST(EngineCommands, TheDiameterOfTheFileHoldsAgainOnceAllLabelsAreTakenBack) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "session").value();
  ASSERT_TRUE(store.add_grid(test::bumpy_scan(0, 11, 4.0)));
  ASSERT_TRUE(store.save_document("pins", pins_to_json(PinSet{2.0, {{0, {{7, {1, 2, 3}}}}}})));
  ASSERT_TRUE(keep_pin_labels(store, 0, {{1, {3, 4, 5}}}, 1.5));
  EXPECT_EQ(session_pins(store).value().value().tip_diameter_mm, 1.5);
  ASSERT_TRUE(keep_pin_labels(store, 0, {}, 1.5));
  const PinSet pins = session_pins(store).value().value();
  EXPECT_EQ(pins.tip_diameter_mm, 2.0);
  EXPECT_EQ(pins.tips.at(0).at(0).label, 7);
}

/// Fixed in the numbers of a map: that scan has no place, and the others are no worse for it.
TEST(EngineCommands, AScanThatLiesTooFarAwayIsFailedAndTheOthersGoOn) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 4);
  std::filesystem::remove(scans / test::scan_name(1));
  const auto session = folder.path() / "session";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    for (int k = 0; k < 3; ++k) {
      RangeGrid grid = test::bumpy_scan(k, k == 1 ? 12 : 11);  // which nothing of the others fits
      grid.source = test::scan_name(k);
      ASSERT_TRUE(store.add_grid(grid));
    }
    RigidTransform far = test::bumpy_pose(1);
    far.translation_mm.x() += 1e7;
    ASSERT_TRUE(record_lock(store, 0, {test::bumpy_pose(0), 1}));
    ASSERT_TRUE(record_lock(store, 1, {far, 1}));
  }
  RunningEngine engine(scans, session, 1e6);
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  ASSERT_EQ(result->poses.size(), 4U);
  for (const ScanPose& pose : result->poses) {
    EXPECT_EQ(pose.status, pose.id == 1 ? PoseStatus::kFailed : PoseStatus::kRegistered)
        << pose.id << pose.reason;
  }
  EXPECT_THAT(result->poses[1].reason,
              HasSubstr("its pose puts it 10000 m from the origin, too far for its samples to keep their "
                        "places to a small part of their spacing; take the offset"));
  EXPECT_THAT(engine.said(), HasSubstr("placed 1 failed"));
  EXPECT_EQ(result->red_map.scans.size(), 3U);
  EXPECT_EQ(result->checklist.scans_failed, 1);
}

/// All of them, where the device itself speaks in such numbers.
TEST(EngineCommands, ScansThatAllLieTooFarAwayEndNoRun) {
  const test::TemporaryFolder folder;
  const auto session = folder.path() / "session";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    for (int k = 0; k < 2; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      grid.source = test::scan_name(k);
      grid.nominal.emplace().tablet_from_scanner = test::bumpy_pose(k);
      grid.nominal->tablet_from_scanner.translation_mm.x() += 1e7;
      ASSERT_TRUE(store.add_grid(grid));
    }
  }
  RunningEngine engine(test::write_bumpy_scans(folder.path() / "scans", 2), session, 1e6);
  const Result<EngineResult>& result = engine.join();
  ASSERT_TRUE(result.has_value()) << result.error().line();
  for (const ScanPose& pose : result->poses) {
    EXPECT_EQ(pose.status, PoseStatus::kFailed);
    EXPECT_THAT(pose.reason, HasSubstr("m from the origin, too far"));
  }
  EXPECT_FALSE(result->red_map.conclusive);
}

// The scanner is being opened for a scan, and the operator takes back the one before: not the next.
TEST(EngineCommands, WhatIsSaidWhileTheDeviceIsOpenedIsDoneBeforeItScans) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 4);
  const auto session = folder.path() / "session";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    ASSERT_TRUE(store.add_grid(test::bumpy_scan(0)));
    ASSERT_TRUE(store.add_grid(test::bumpy_scan(1)));
  }
  std::vector<std::string> said;
  std::mutex mutex;
  Engine engine({"replay:" + scans.string(), session, false, 0, std::nullopt}, [&](const Event& event) {
    const std::scoped_lock lock(mutex);
    if (const auto* obeyed = std::get_if<OperatorObeyed>(&event)) {
      said.push_back(obeyed->what);
    } else if (const auto* placed = std::get_if<ScanPlaced>(&event); placed && placed->pose.id == 2) {
      said.emplace_back("a new scan");
    }
  });
  ASSERT_TRUE(engine.post(DropScan{-1, "undone by the operator"}));
  TabletRecord record;
  record.museum_number = "VAT 1";
  ASSERT_TRUE(engine.post(DescribeTablet{record}));
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  ASSERT_TRUE(result.has_value()) << result.error().line();
  EXPECT_THAT(said, ElementsAre("scan 1 is taken out", "a new scan"));
  EXPECT_FALSE(engine.post(LockScan{0})) << "it has ended";
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store.has_value());
  EXPECT_EQ(tablet_record_of(*store).museum_number, "VAT 1");
  const auto stored = store->scans();
  for (const StoredScan& scan : *stored) {
    EXPECT_EQ(scan.dropped, scan.id == 1) << scan.id;
  }
}

}  // namespace
}  // namespace dubsar
