// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "core/grid_geometry.h"
#include "core/units.h"
#include "formats/grid_reader.h"
#include "formats/poses_conf.h"
#include "registration/registrar.h"
#include "tests/registration/support/gauge.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

TEST(RealScans, BunnyWithNoHints) {
  const std::filesystem::path folder = test::real_data() / "stanford_bunny";
  if (!std::filesystem::exists(folder / "bun.conf")) {
    GTEST_SKIP() << "no " << folder.string() << ": set DUBSAR_DATA to the folder of real scans";
  }
  const auto published = read_conf_poses(folder / "bun.conf", 1000.0);
  ASSERT_TRUE(published) << published.error().line();
  std::map<std::string, RigidTransform> truth;
  for (const ScanPose& pose : *published) {
    truth[pose.file] = pose.model_from_scanner;
  }
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  for (const auto& [file, pose] : truth) {
    auto scans = read_scan_file(folder / file, {.mm_per_unit = 1000.0});
    ASSERT_TRUE(scans) << scans.error().line();
    RangeGrid grid = std::get<RangeGrid>(std::move(scans->front()));
    grid.spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
    grids.push_back(std::make_shared<const RangeGrid>(std::move(grid)));
  }
  ASSERT_EQ(grids.size(), 10U);
  Registrar registrar;
  JobContext job;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    registrar.add(static_cast<int>(k), grids[k], nullptr, job);
  }
  ASSERT_TRUE(registrar.finalize(job));
  for (const testing::GaugeError& error : testing::gauge_errors(registrar.poses(), truth, grids)) {
    EXPECT_EQ(error.pose.status, PoseStatus::kRegistered) << error.pose.file << ": " << error.pose.reason;
    EXPECT_LT(deg_from_rad(error.turn_rad), 0.5) << error.pose.file;
    EXPECT_LT(error.shift_mm, 0.5) << error.pose.file;
  }
}

}  // namespace
}  // namespace dubsar
