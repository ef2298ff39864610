// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scan is registered while it is being stored; nothing of it is told or saved before it is on disk.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include "acquisition/session_store.h"
#include "acquisition/sqlite_db.h"
#include "build_paths.h"
#include "core/grid_rows.h"
#include "formats/grid_file.h"
#include "station/engine.h"
#include "station/unfinished_scan.h"
#include "tests/acquisition/session_support.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> run(const fs::path& scans, const fs::path& session,
                             const std::function<void(const ScanStored&)>& on_stored,
                             std::optional<Result<EngineResult>>& result) {
  std::mutex mutex;
  std::vector<std::string> said;
  Engine engine({"replay:" + scans.string(), session, false, 0, std::nullopt}, [&](const Event& event) {
    const std::scoped_lock lock(mutex);
    if (const auto* notice = std::get_if<Notice>(&event)) {
      said.push_back(notice->text);
    } else if (const auto* stored = std::get_if<ScanStored>(&event)) {
      said.push_back("stored " + std::to_string(stored->id));
      on_stored(*stored);
    } else if (const auto* placed = std::get_if<ScanPlaced>(&event)) {
      said.push_back("placed " + std::to_string(placed->pose.id));
    }
  });
  JobContext job;
  result.emplace(engine.run(job));
  return said;
}

TEST(EngineStoring, EveryScanIsStoredBeforeItIsPlaced) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, folder.path() / "session", [](const ScanStored&) {}, result);
  ASSERT_TRUE(result->has_value()) << result->error().line();
  for (const char* const number : {"0", "1", "2"}) {
    const std::string id = number;
    const auto stored = std::find(said.begin(), said.end(), "stored " + id);
    const auto placed = std::find(said.begin(), said.end(), "placed " + id);
    EXPECT_NE(placed, said.end());
    EXPECT_LT(stored, placed) << id;
  }
}

TEST(EngineStoring, WhatCouldNotBeStoredLeavesNoTrace) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  const auto session = folder.path() / "session";
  const auto away = folder.path() / "away";
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, session,
      [&](const ScanStored&) {
        // From now on there is no folder to write a grid to.
        fs::rename(session / "grids", away);
        std::ofstream(session / "grids") << "in the way";
      },
      result);
  ASSERT_FALSE(result->has_value());
  EXPECT_THAT(said, ::testing::IsSupersetOf({"stored 0", "placed 0"}));
  EXPECT_THAT(said, ::testing::Not(Contains(::testing::AnyOf("stored 1", "placed 1"))));
  fs::remove(session / "grids");
  fs::rename(away, session / "grids");
  const Result<SessionStore> store = SessionStore::open(session);
  ASSERT_TRUE(store.has_value()) << store.error().line();
  std::vector<int> ids;
  const Result<std::vector<ScanPose>> poses = store->poses();
  ASSERT_TRUE(poses.has_value());
  for (const ScanPose& pose : *poses) {
    ids.push_back(pose.id);
  }
  EXPECT_THAT(ids, ElementsAre(0));
  EXPECT_EQ(store->scans()->size(), 1U);
}

/// A scan in whose middle a program ended, in four files, the second of them damaged.
void leave_rows(const fs::path& folder, const RangeGrid& grid) {
  fs::create_directories(folder);
  const int rows = grid.rows / 4;
  for (int file = 0; file < 4; ++file) {
    EXPECT_TRUE(
        write_grid_file(folder / ("000" + std::to_string(file) + ".grid"), rows_of(grid, file * rows, rows)));
  }
  test::flip_byte(folder / "0001.grid", 1000);
}

TEST(EngineStoring, RowsAroundADamagedFileAreKeptAndTheFileToo) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 1);
  const auto session = folder.path() / "session";
  { ASSERT_TRUE(SessionStore::open_or_create(session)); }
  const RangeGrid broken_off = test::bumpy_scan(1);
  const fs::path unfinished = session / "grids" / "unfinished";
  leave_rows(unfinished / "1", broken_off);
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, session, [](const ScanStored&) {}, result);
  ASSERT_TRUE(result->has_value()) << result->error().line();
  EXPECT_THAT(said, Contains(HasSubstr("damaged: grids/unfinished/1/0001.grid: ")));
  EXPECT_THAT(said, Contains("what can be read of that scan is stored; all of its files stay in "
                             "grids/unfinished/1.damaged-1"));
  EXPECT_TRUE(fs::exists(unfinished / "1.damaged-1" / "0001.grid"));
  const int rows = broken_off.rows / 4;
  {
    const Result<SessionStore> store = SessionStore::open(session);
    ASSERT_TRUE(store && store->scans());
    ASSERT_EQ(store->scans()->size(), 3U);
    EXPECT_EQ(store->load_grid(0).value().z, rows_of(broken_off, 0, rows).z);
    EXPECT_EQ(store->load_grid(1).value().z, rows_of(broken_off, 2 * rows, 2 * rows).z);
    JobContext job;
    const auto report = store->verify(job);
    ASSERT_TRUE(report);
    EXPECT_TRUE(report->ok());
    EXPECT_THAT(report->set_aside, Contains("grids/unfinished/1.damaged-1/0001.grid"));
  }
}

TEST(EngineStoring, PartsThatWereStoredBeforeAKillAreNotStoredAgain) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 1);
  const auto session = folder.path() / "session";
  const RangeGrid broken_off = test::bumpy_scan(1);
  const int rows = broken_off.rows / 4;
  {
    Result<SessionStore> store = SessionStore::open_or_create(session);
    ASSERT_TRUE(store && store->add_grid(rows_of(broken_off, 0, rows)) &&
                store->add_grid(rows_of(broken_off, 2 * rows, 2 * rows)));
  }
  leave_rows(session / "grids" / "unfinished" / "1", broken_off);
  std::optional<Result<EngineResult>> result;
  run(
      scans, session, [](const ScanStored&) {}, result);
  ASSERT_TRUE(result->has_value()) << result->error().line();
  EXPECT_EQ(SessionStore::open(session).value().scans()->size(), 3U);
}

/// Until something of the scan under way is on disk: its device waits for who looks at its rows.
void wait_for_rows(const fs::path& unfinished) {
  for (int k = 0; k < 20 && !fs::exists(unfinished / "1" / "0000.grid"); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

TEST(EngineStoring, RowsStayWhereTheScanGetsNoNumber) {
  const test::TemporaryFolder folder;
  const auto session = folder.path() / "session";
  const fs::path unfinished = session / "grids" / "unfinished";
  const fs::path last = session / "grids" / "99999999.grid";
  const auto hear = [&](const Event& event) {
    const auto* profile = std::get_if<ProfileArrived>(&event);
    if (profile != nullptr && profile->row > 30) {  // the first ones see nothing of the tablet
      wait_for_rows(unfinished);
    } else if (std::holds_alternative<DeviceStarts>(event)) {
      fs::create_directories(last.parent_path());
      std::ofstream(last) << "the last number that there is";
    }
  };
  JobContext job;
  const Result<EngineResult> result =
      Engine({"sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02", session, false, 0, std::nullopt}, hear)
          .run(job);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().line(), HasSubstr("no number is left"));
  EXPECT_TRUE(fs::exists(unfinished / "1" / "0000.grid"));
  fs::remove(last);
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 1);
  std::optional<Result<EngineResult>> again;
  EXPECT_THAT(run(
                  scans, session, [](const ScanStored&) {}, again),
              Contains(HasSubstr("a scan in whose middle the program ended is kept")));
}

TEST(EngineStoring, LeftRowsAreStoredAlsoWhereTheirDriveCannotBeKept) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 1);
  const auto session = folder.path() / "session";
  { ASSERT_TRUE(SessionStore::open_or_create(session)); }
  {
    Result<SqlDatabase> db = SqlDatabase::open(session / "session.sqlite", SqlDatabase::Mode::kCreate);
    ASSERT_TRUE(db &&
                db->execute("CREATE TRIGGER refuses BEFORE INSERT ON documents WHEN new.name = 'drives' "
                            "BEGIN SELECT raise(ABORT, 'no room for drives'); END"));
    Placement drive;
    drive.turntable_rad = 0.5;
    UnfinishedScan left(session, drive, std::chrono::milliseconds(0));
    while (!fs::exists(session / "grids" / "unfinished" / "1" / "0000.grid")) {
      left.follow(test::bumpy_scan(1), 0);
    }
    left.leave();
  }
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, session, [](const ScanStored&) {}, result);
  ASSERT_TRUE(result->has_value()) << result->error().line();
  EXPECT_THAT(said, ::testing::IsSupersetOf({"stored 0", "stored 1"}));
  EXPECT_THAT(said, Contains(HasSubstr("no room for drives")));
}

TEST(EngineStoring, AScanThatIsLostIsTakenFromItsFileAgain) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  const auto session = folder.path() / "session";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    for (int k = 0; k < 3; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      grid.source = test::scan_name(k);
      ASSERT_TRUE(store.add_grid(grid));
    }
    ASSERT_TRUE(store.drop_scan(2, "a hand in it"));
  }
  test::flip_byte(session / "grids" / "001.grid", 1000);
  test::flip_byte(session / "grids" / "002.grid", 1000);
  std::optional<Result<EngineResult>> result;
  EXPECT_THAT(run(
                  scans, session, [](const ScanStored&) {}, result),
              Contains("stored 3"));
  ASSERT_TRUE(result->has_value()) << result->error().line();
  const SessionStore store = SessionStore::open(session).value();
  ASSERT_EQ(store.scans()->size(), 4U) << "what the operator took out stays out";
  EXPECT_EQ(store.scans()->back().source, test::scan_name(1));
  EXPECT_EQ(store.load_grid(3).value().z, test::bumpy_scan(1).z);
}

TEST(EngineStoring, WhatADeviceLostOfAScanIsSaidAndKept) {
  const test::TemporaryFolder folder;
  ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/good", 1);
  std::vector<std::string> remarks;
  Engine engine({"odd:1?mode=ragged", folder.path() / "s", false, 1, std::nullopt}, [&](const Event& event) {
    if (const auto* stored = std::get_if<ScanStored>(&event)) {
      remarks.push_back(stored->remark);
    }
  });
  JobContext job;
  [[maybe_unused]] const auto result = engine.run(job);  // too few samples for a mesh
  EXPECT_THAT(remarks, ElementsAre(HasSubstr("rows lost: 1, rows that came twice: 1")));
  const SessionStore store = SessionStore::open(folder.path() / "s", SessionStore::Access::kReadOnly).value();
  EXPECT_THAT(store.scans()->at(0).remark, HasSubstr("samples that are no places: 3"));
}

}  // namespace
}  // namespace dubsar
