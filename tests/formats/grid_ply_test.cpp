// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_ply.h"

#include "formats/grid_reader.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using testing::expect_same_grid;
using ::testing::HasSubstr;
using testing::line_of;
using testing::sample_grid;
using testing::ScratchFolder;

TEST(GridPly, ReadsBackToTheBit) {
  for (const bool ascii : {false, true}) {
    for (const bool everything : {false, true}) {
      const RangeGrid grid = sample_grid(31, 17, everything);
      const auto scans = read_scan_bytes(encode_grid_ply(grid, {.ascii = ascii}), "dir/a.ply");
      ASSERT_TRUE(scans) << line_of(scans);
      ASSERT_EQ(scans->size(), 1U);
      expect_same_grid(grid, std::get<RangeGrid>(scans->front()));
      EXPECT_EQ(std::get<RangeGrid>(scans->front()).source, "a.ply");
    }
  }
}

TEST(GridPly, KeepsTheOriginalNameAndTheLabelWhereItIsAskedTo) {
  RangeGrid grid = sample_grid(4, 5, true);
  grid.source = "front side.ply\nelement vertex 9";
  const std::string bytes = encode_grid_ply(
      grid,
      {.keep_source = true, .label = {.name = "BM 1", .words = {{"Museum number", "BM 1\nend_header"}}}});
  EXPECT_THAT(bytes, HasSubstr("\ncomment Museum number: BM 1 end header\n"));
  const auto scans = read_scan_bytes(bytes, "dir/003.ply");
  ASSERT_TRUE(scans) << line_of(scans);
  expect_same_grid(grid, std::get<RangeGrid>(scans->front()));
  EXPECT_EQ(std::get<RangeGrid>(scans->front()).source, "front side.ply element vertex 9");
}

TEST(GridPly, WritesAFileThatIsSeenAsAScan) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_grid_ply(folder / "a.ply", sample_grid(4, 5, true)));
  EXPECT_TRUE(looks_like_scan(folder / "a.ply"));
  EXPECT_EQ(count_scans(folder / "a.ply").value(), 1);
  EXPECT_TRUE(read_scan_file(folder / "a.ply"));
}

TEST(GridPly, AWordOfTheCallerOnTheUnitWins) {
  const RangeGrid grid = sample_grid(4, 5, false);
  const auto scans = read_scan_bytes(encode_grid_ply(grid), "a.ply", {.mm_per_unit = 1000.0});
  ASSERT_TRUE(scans);
  const auto& back = std::get<RangeGrid>(scans->front());
  const std::size_t i =
      static_cast<std::size_t>(std::find(grid.valid.begin(), grid.valid.end(), 1) - grid.valid.begin());
  EXPECT_FLOAT_EQ(back.x[i], 1000 * grid.x[i]);
  EXPECT_GT(back.spacing_mm, 50) << "the spacing must follow the unit";
}

}  // namespace
}  // namespace dubsar
