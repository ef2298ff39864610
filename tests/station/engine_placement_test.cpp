// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which scans were taken without lifting the tablet: the motors' word holds among those alone.

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "formats/grid_file.h"
#include "station/engine.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

RangeGrid placed(int number, int placement) {
  RangeGrid grid = test::bumpy_scan(number);
  grid.nominal.emplace();
  grid.nominal->tablet_from_scanner = test::bumpy_pose(number);
  grid.nominal->placement = placement;
  grid.nominal->sigma_mm = grid.nominal->hand_sigma_mm = 5;
  grid.nominal->sigma_rad = grid.nominal->hand_sigma_rad = 0.5;
  return grid;
}

/// Scans 0 to 2 stand in the session, 2 after a turn by hand; it goes on, and the placement of scan 3 is
/// told.
int placement_that_follows(const std::filesystem::path& folder, bool is_dropped, bool is_damaged) {
  const auto session = folder / "s";
  {
    SessionStore store = SessionStore::open_or_create(session).value();
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(store.add_grid(placed(k, k == 2 ? 1 : 0)));
    }
    EXPECT_TRUE(!is_dropped || store.drop_scan(2, "a test"));
  }
  if (is_damaged) {
    std::filesystem::resize_file(session / "grids/002.grid", 100);
  }
  std::filesystem::create_directories(folder / "next");
  RangeGrid next = placed(3, 0);
  next.source = "next.grid";
  EXPECT_TRUE(write_grid_file(folder / "next/next.grid", next));
  Engine engine({"replay:" + (folder / "next").string(), session, false, 0, std::nullopt}, nullptr);
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  EXPECT_TRUE(result) << result.error().line();
  const RangeGrid stored =
      SessionStore::open(session, SessionStore::Access::kReadOnly).value().load_grid(3).value();
  return stored.nominal ? stored.nominal->placement : -1;
}

TEST(EnginePlacement, AScanThatWasTakenOutKeepsItsPlacementForItself) {
  for (const bool is_dropped : {false, true}) {
    for (const bool is_damaged : {false, true}) {
      const test::TemporaryFolder folder;
      const int placement = placement_that_follows(folder.path(), is_dropped, is_damaged);
      EXPECT_GE(placement, 2) << is_dropped << is_damaged;
      EXPECT_TRUE(is_damaged || placement == 2) << is_dropped << placement;
    }
  }
}

}  // namespace
}  // namespace dubsar
