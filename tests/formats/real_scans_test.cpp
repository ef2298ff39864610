// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_reader.h"
#include "tests/formats/format_support.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

using testing::line_of;

RangeGrid read_grid(const std::filesystem::path& path) {
  const auto scans = read_scan_file(path, {.mm_per_unit = 1000.0});
  EXPECT_TRUE(scans) << line_of(scans);
  return scans ? std::get<RangeGrid>(scans->front()) : RangeGrid{};
}

TEST(RealScans, Bunny) {
  const auto folder = test::real_data() / "stanford_bunny";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no real scans beside the project";
  }
  const RangeGrid grid = read_grid(folder / "bun000.ply");
  EXPECT_EQ(grid.rows, 400);
  EXPECT_EQ(grid.cols, 512);
  EXPECT_EQ(grid.valid_count(), 40256U);
  // 0.500 mm along the rows, 0.745 mm from row to row (computed apart from this program); µ is the larger.
  EXPECT_NEAR(grid.spacing_mm, 0.7447, 1e-3);
  EXPECT_EQ(grid.source, "bun000.ply");
  int scans = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    scans += entry.is_regular_file() && looks_like_scan(entry.path()) ? 1 : 0;
  }
  EXPECT_EQ(scans, 10) << ".conf and README are no scans";
  EXPECT_FALSE(looks_like_scan(folder / "reconstruction" / "bun_zipper.ply"));
  EXPECT_FALSE(read_scan_file(folder / "bun.conf"));
}

TEST(RealScans, DragonWithStrayHeaderLines) {
  const auto folder = test::real_data() / "stanford_dragon_stand";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no real scans beside the project";
  }
  int scans = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!looks_like_scan(entry.path())) {
      continue;
    }
    ++scans;
    const RangeGrid grid = read_grid(entry.path());
    EXPECT_GT(grid.valid_count(), 10000U) << entry.path();
    EXPECT_GT(grid.spacing_mm, 0.2) << entry.path();
    EXPECT_LT(grid.spacing_mm, 1.2) << entry.path();
  }
  EXPECT_EQ(scans, 15);
  const RangeGrid grid = read_grid(folder / "dragonStandRight_0.ply");
  EXPECT_EQ(grid.valid_count(), 41841U);
}

}  // namespace
}  // namespace dubsar
