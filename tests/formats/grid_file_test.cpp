// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_file.h"

#include <limits>

#include "formats/atomic_file.h"
#include "formats/grid_chunks.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using testing::expect_same_grid;
using ::testing::HasSubstr;
using testing::line_of;
using testing::sample_grid;
using testing::ScratchFolder;

RangeGrid full_grid() {
  RangeGrid grid = sample_grid(37, 53, true);
  NominalPose pose;
  pose.tablet_from_scanner = RigidTransform::from_twist({0.1, 2.0, -0.3}, {1.0 / 3, -7, 1e-9});
  pose.placement = 3;
  pose.sigma_mm = 0.011;
  pose.hand_sigma_rad = 0.17;
  grid.nominal = pose;
  return grid;
}

TEST(GridFile, GivesEveryFieldBackToTheBit) {
  const RangeGrid grid = full_grid();
  const auto back = decode_grid(encode_grid(grid), "t");
  ASSERT_TRUE(back) << line_of(back);
  expect_same_grid(grid, *back);
  EXPECT_EQ(back->source, grid.source);
  ASSERT_TRUE(back->nominal);
  EXPECT_EQ(back->nominal->tablet_from_scanner.row_major(), grid.nominal->tablet_from_scanner.row_major());
  EXPECT_EQ(back->nominal->placement, 3);
  EXPECT_EQ(back->nominal->sigma_mm, 0.011);
  EXPECT_EQ(back->nominal->sigma_rad, grid.nominal->sigma_rad);
  EXPECT_EQ(back->nominal->hand_sigma_mm, grid.nominal->hand_sigma_mm);
  EXPECT_EQ(back->nominal->hand_sigma_rad, 0.17);
}

TEST(GridFile, OptionalPartsStayAbsent) {
  const auto back = decode_grid(encode_grid(sample_grid(5, 9, false)), "t");
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->intensity.empty());
  EXPECT_TRUE(back->rgb.empty());
  EXPECT_FALSE(back->nominal);
  EXPECT_FALSE(back->view.laser_mm);
}

TEST(GridFile, TakesEmptyAndSingleCellGrids) {
  for (const auto& [rows, cols] : {std::pair{0, 0}, {1, 1}, {1, 17}, {8, 1}}) {
    const RangeGrid grid = sample_grid(rows, cols, true);
    const auto back = decode_grid(encode_grid(grid), "t");
    ASSERT_TRUE(back) << line_of(back);
    expect_same_grid(grid, *back);
  }
}

TEST(GridFile, SameGridSameBytes) {
  EXPECT_EQ(encode_grid(full_grid()), encode_grid(full_grid()));
}

TEST(GridFile, EveryChangedByteIsSeen) {
  RangeGrid grid = sample_grid(6, 7, true);
  std::vector<std::byte> bytes = encode_grid(grid);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= std::byte{0x10};
    EXPECT_FALSE(verify_grid_bytes(bytes, "t")) << "byte " << i;
    EXPECT_FALSE(decode_grid(bytes, "t")) << "byte " << i;
    bytes[i] ^= std::byte{0x10};
  }
  EXPECT_TRUE(verify_grid_bytes(bytes, "t"));
}

TEST(GridFile, EveryTruncationIsSeen) {
  const std::vector<std::byte> bytes = encode_grid(sample_grid(6, 7, true));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_grid(std::span(bytes).first(size), "t")) << size;
  }
  EXPECT_THAT(line_of(decode_grid(std::span(bytes).first(100), "t")),
              HasSubstr("t: cut short: 100 bytes instead of"));
  EXPECT_THAT(line_of(decode_grid({}, "t")), HasSubstr("t: the file is empty"));
}

TEST(GridFile, SaysWhatIsWrong) {
  std::vector<std::byte> bytes = encode_grid(sample_grid(6, 7, true));
  bytes[60] ^= std::byte{1};
  EXPECT_THAT(line_of(verify_grid_bytes(bytes, "t")),
              HasSubstr("t: its bytes do not match their checksum; restore the file from a copy"));
  bytes[8] = std::byte{9};
  EXPECT_THAT(line_of(verify_grid_bytes(bytes, "t")), HasSubstr("grid version 9 is not known"));
  bytes[0] = std::byte{'x'};
  EXPECT_THAT(line_of(verify_grid_bytes(bytes, "t")), HasSubstr("not a grid file of Dubsar"));
}

TEST(GridFile, WritesReadsAndVerifiesFiles) {
  const ScratchFolder folder;
  const RangeGrid grid = full_grid();
  ASSERT_TRUE(write_grid_file(folder / "a.grid", grid));
  EXPECT_TRUE(verify_grid_file(folder / "a.grid"));
  const auto back = read_grid_file(folder / "a.grid");
  ASSERT_TRUE(back);
  expect_same_grid(grid, *back);
  EXPECT_FALSE(verify_grid_file(folder / "none.grid"));
}

TEST(GridFile, ACellWithoutAPlaceIsNoReturn) {
  RangeGrid grid = sample_grid(4, 4, false);
  grid.valid[5] = 1;
  grid.z[5] = std::numeric_limits<float>::quiet_NaN();
  const auto back = decode_grid(encode_grid(grid), "t");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->valid[5], 0);
}

TEST(GridChunks, KeepEveryBitPattern) {
  std::vector<float> values{0.0F, -0.0F, 1e-45F, std::numeric_limits<float>::infinity(), -1e38F, 3.0F};
  values.push_back(std::bit_cast<float>(0x7fc12345U));
  std::vector<float> back(values.size());
  ASSERT_TRUE(unpack_floats(pack_floats(values), back));
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(values[i]), std::bit_cast<std::uint32_t>(back[i]));
  }
  std::vector<float> shorter(values.size() - 1);
  EXPECT_FALSE(unpack_floats(pack_floats(values), shorter));
  std::vector<float> longer(values.size() + 1);
  EXPECT_FALSE(unpack_floats(pack_floats(values), longer));
}

}  // namespace
}  // namespace dubsar
