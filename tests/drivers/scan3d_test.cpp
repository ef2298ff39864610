// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the numbers of a range camera mean, byte by byte.
#include "drivers/aravis/scan3d.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "drivers/aravis/close_up.h"
#include "drivers/aravis/options.h"

namespace dubsar::aravis {
namespace {

Scan3d meaning_of(const char* format, std::uint32_t width, std::uint32_t height) {
  Scan3d out;
  out.format = *range_format(std::string(format));
  out.width = width;
  out.height = height;
  out.axes[0] = {0.5, -1, std::nullopt};
  out.axes[1] = {2, 0, std::nullopt};
  out.axes[2] = {0.1, 10, 0.0};
  return out;
}

std::vector<std::uint8_t> bytes_of(const std::vector<float>& numbers) {
  std::vector<std::uint8_t> out(4 * numbers.size());
  std::memcpy(out.data(), numbers.data(), out.size());
  return out;
}

TEST(Padding, RowsOfAFrameAreClosedUp) {
  std::vector<std::uint8_t> frame{1, 2, 3, 0xee, 4, 5, 6, 0xee, 7, 8, 9};
  close_up_rows(frame.data(), 3, 3, 4);
  frame.resize(9);
  EXPECT_EQ(frame, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(Scan3d, CMeansDepthOverColumns) {
  const Scan3d meaning = meaning_of("Coord3D_C16", 3, 2);
  const std::vector<std::uint8_t> frame{1, 0, 0, 0, 0, 1, 100, 0, 200, 0, 0xff, 0xff};
  ProfileRow row;
  read_row(meaning, frame, 1, 7, row);
  EXPECT_FLOAT_EQ(row.z[0], 20);
  EXPECT_FLOAT_EQ(row.z[2], 6563.5F);
  EXPECT_FLOAT_EQ(row.x[1], -0.5);
  EXPECT_FLOAT_EQ(row.y[0], 7);
  read_row(meaning, frame, 0, 0, row);
  EXPECT_EQ(row.valid, (std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_TRUE(std::isnan(row.z[1]));
  EXPECT_FLOAT_EQ(row.z[2], 35.6F);
}

TEST(Scan3d, PlanarAndPackedSayTheSame) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto packed = bytes_of({1, 2, 3, 4, 5, kNan, 7, 8, 9, kInfinity, 11, 12});
  const auto planar = bytes_of({1, 4, 7, kInfinity, 2, 5, 8, 11, 3, kNan, 9, 12});
  ProfileRow a;
  ProfileRow b;
  for (std::uint32_t row = 0; row < 2; ++row) {
    read_row(meaning_of("Coord3D_ABC32f", 2, 2), packed, row, 0, a);
    read_row(meaning_of("Coord3D_ABC32f_Planar", 2, 2), planar, row, 0, b);
    EXPECT_EQ(a.valid, (std::vector<std::uint8_t>{1, 0}));
    EXPECT_EQ(a.valid, b.valid);
    EXPECT_EQ(a.x[0], b.x[0]);
    EXPECT_EQ(a.y[0], b.y[0]);
    EXPECT_EQ(a.z[0], b.z[0]);
  }
  EXPECT_FLOAT_EQ(a.x[0], 2.5F);
  EXPECT_FLOAT_EQ(a.y[0], 16);
  EXPECT_FLOAT_EQ(a.z[0], 10.9F);
}

TEST(Scan3d, InchesFlipsAndInvalidValues) {
  Scan3d meaning = meaning_of("Coord3D_AC32f", 2, 1);
  meaning.unit_mm = 25.4;
  meaning.flip_z = true;
  meaning.axes[2].invalid = -999.9;  // a float cannot be quite that
  const auto frame = bytes_of({2, 10, 4, -999.9F});
  ProfileRow row;
  read_row(meaning, frame, 0, 3, row);
  EXPECT_EQ(row.valid, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_NEAR(row.x[0], 0, 1e-6);
  EXPECT_NEAR(row.z[0], -11 * 25.4, 1e-3);
}

TEST(Scan3d, WhatCannotBeIsRefused) {
  EXPECT_TRUE(check(meaning_of("Coord3D_C16", 3, 2), "cam"));
  Scan3d bad = meaning_of("Coord3D_C16", 0, 2);
  EXPECT_EQ(check(bad, "cam").error().kind, ErrorKind::kBadInput);
  bad = meaning_of("Coord3D_C16", 3, 2);
  bad.axes[2].scale = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check(bad, "cam"));
  bad.axes[2].scale = 0;
  EXPECT_FALSE(check(bad, "cam"));
  EXPECT_EQ(range_format(std::string("Mono8")), nullptr);
  for (const RangeFormat& format : range_formats()) {
    EXPECT_EQ(format.sample_bytes() * 8, format.code >> 16U & 0xffU) << format.name;
    EXPECT_EQ(range_format(format.code), &format);
  }
}

/// Rows of a camera that knows no B came out a millimetre apart, whatever the stage did.
TEST(Scan3d, RowsAndColumnsThatLieNobodyKnowsWhereAreRefused) {
  Scan3d meaning = meaning_of("Coord3D_AC32f", 3, 2);
  const Status rows = check_places(meaning, 0, "cam");
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().kind, ErrorKind::kUsage);
  EXPECT_NE(rows.error().line().find("how far apart the rows lie; give row="), std::string::npos)
      << rows.error().line();
  EXPECT_TRUE(check_places(meaning, 0.05, "cam"));
  meaning.axes[1].told = true;
  EXPECT_TRUE(check_places(meaning, 0, "cam"));
  meaning.format = *range_format(std::string("Coord3D_C16"));
  const Status columns = check_places(meaning, 0, "cam");
  ASSERT_FALSE(columns);
  EXPECT_NE(columns.error().mend.find("Coord3D_AC"), std::string::npos) << columns.error().line();
  meaning.axes[0].told = true;
  EXPECT_TRUE(check_places(meaning, 0, "cam"));
  EXPECT_TRUE(check_places(meaning_of("Coord3D_ABC32f", 3, 2), 0, "cam"));  // the data bring all along
}

TEST(AravisOptions, AreChecked) {
  const std::vector<dubsar_option> good{
      {"rows", "400"}, {"row", "0.05"}, {"count", "-0.001"}, {"resend", "0"}};
  const auto parsed = parse_options(good);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->rows, 400);
  EXPECT_FALSE(parsed->resend);
  for (const dubsar_option& bad :
       {dubsar_option{"rows", "0"}, dubsar_option{"rows", "1.5"}, dubsar_option{"wait", "-1"},
        dubsar_option{"packet", "12"}, dubsar_option{"flip", "maybe"}}) {
    EXPECT_EQ(parse_options(std::span(&bad, 1)).error().kind, ErrorKind::kUsage) << bad.key;
  }
}

}  // namespace
}  // namespace dubsar::aravis
