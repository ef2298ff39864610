// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_scan.h"

#include "formats/byte_order.h"
#include "formats/grid_ply.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;

/// A 2 × 3 grid of four samples; parts can be swapped for broken ones.
struct Parts {
  std::string format = "ascii";
  std::string info = "obj_info num_cols 3\nobj_info num_rows 2\n";
  std::string vertex = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  std::string grid = "element range_grid 6\nproperty list uchar int vertex_indices\n";
  std::string body = "0 0 0\n1 0 0.5\n0 1 0\n1 1 0\n1 0\n1 1\n0\n1 2\n0\n1 3\n";

  [[nodiscard]] std::string text() const {
    return "ply\nformat " + format + " 1.0\n" + info + vertex + grid + "end_header\n" + body;
  }
};

std::string line(const Parts& parts) {
  return line_of(read_scan_bytes(parts.text(), "a.ply"));
}

RangeGrid grid_of(const std::string& text, const GridReadOptions& options = {}) {
  const auto scans = read_scan_bytes(text, "a.ply", options);
  EXPECT_TRUE(scans) << line_of(scans);
  return scans && std::holds_alternative<RangeGrid>(scans->front()) ? std::get<RangeGrid>(scans->front())
                                                                    : RangeGrid{};
}

void expect_the_grid(const RangeGrid& grid) {
  ASSERT_EQ(grid.rows, 2);
  ASSERT_EQ(grid.cols, 3);
  EXPECT_EQ(grid.valid, (std::vector<std::uint8_t>{1, 1, 0, 1, 0, 1}));
  EXPECT_EQ(grid.point(1), Eigen::Vector3f(1, 0, 0.5F));
  EXPECT_EQ(grid.point(5), Eigen::Vector3f(1, 1, 0));
  EXPECT_EQ(grid.view.direction, Eigen::Vector3d(0, 0, -1));
  EXPECT_FLOAT_EQ(static_cast<float>(grid.spacing_mm), 1.0F);
}

std::string binary_text(std::endian order) {
  Parts parts;
  parts.format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
  parts.vertex =
      "element vertex 4\nproperty short odd\nproperty double x\nproperty float y\nproperty list ushort char "
      "skip\n"
      "property float z\n";
  parts.grid =
      "element range_grid 6\nproperty list int uint vertex_indices\nelement more 2\nproperty char c\n";
  parts.body.clear();
  for (const auto& [x, y, z] :
       {std::tuple{0.0, 0.0F, 0.0F}, {1.0, 0.0F, 0.5F}, {0.0, 1.0F, 0.0F}, {1.0, 1.0F, 0.0F}}) {
    append(parts.body, std::int16_t{-7}, order);
    append(parts.body, x, order);
    append(parts.body, y, order);
    append(parts.body, std::uint16_t{2}, order);
    parts.body += "ab";
    append(parts.body, z, order);
  }
  std::uint32_t next = 0;
  for (const int valid : {1, 1, 0, 1, 0, 1}) {
    append(parts.body, std::int32_t{valid}, order);
    if (valid != 0) {
      append(parts.body, next++, order);
    }
  }
  parts.body += "cc";
  return parts.text();
}

TEST(PlyScan, ReadsAscii) {
  expect_the_grid(grid_of(Parts{}.text()));
}

TEST(PlyScan, ReadsBothByteOrdersAndAnyTypes) {
  expect_the_grid(grid_of(binary_text(std::endian::little)));
  expect_the_grid(grid_of(binary_text(std::endian::big)));
}

TEST(PlyScan, ReadsCarriageReturnsAndStrayHeaderLines) {
  Parts parts;
  parts.info = "bye\nbye\nbye\n" + parts.info + "comment x\n";
  std::string crlf;
  for (const char c : parts.text()) {
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
  }
  expect_the_grid(grid_of(crlf));
}

TEST(PlyScan, ReadsTheGridBeforeTheVertices) {
  Parts parts;
  std::swap(parts.vertex, parts.grid);
  parts.body = "1 0\n1 1\n0\n1 2\n0\n1 3\n0 0 0\n1 0 0.5\n0 1 0\n1 1 0\n";
  expect_the_grid(grid_of(parts.text()));
}

TEST(PlyScan, TakesTheUnitFromTheFileUnlessTold) {
  Parts parts;
  parts.info += "obj_info unit m\n";
  EXPECT_EQ(grid_of(parts.text()).point(1), Eigen::Vector3f(1000, 0, 500));
  EXPECT_EQ(grid_of(parts.text(), {.mm_per_unit = 0.5}).point(1), Eigen::Vector3f(0.5F, 0, 0.25F));
  parts.info += "obj_info unit furlong\n";
  parts.info.replace(parts.info.find("unit m\n"), 6, "unit ell");
  EXPECT_THAT(line(parts),
              HasSubstr("a.ply: obj_info unit is 'ell', not m, cm, mm, um or in; say what the numbers are"));
}

TEST(PlyScan, CentimetresAndInchesAreUnits) {
  Parts parts;
  parts.info += "obj_info unit cm\n";
  EXPECT_EQ(grid_of(parts.text()).point(1), Eigen::Vector3f(10, 0, 5));
  parts.info.replace(parts.info.find("unit cm"), 7, "unit in");
  EXPECT_EQ(grid_of(parts.text()).point(1), Eigen::Vector3f(25.4F, 0, 12.7F));
}

TEST(PlyScan, UnitsAreReadAsPeopleWriteThem) {
  for (const auto& [unit, mm] : {std::pair("Meters", 1000.0F),
                                 {"metre", 1000.0F},
                                 {"M", 1000.0F},
                                 {"MM", 1.0F},
                                 {"millimeters", 1.0F},
                                 {"Millimetre", 1.0F},
                                 {"centimetres", 10.0F},
                                 {"inch", 25.4F},
                                 {"Inches", 25.4F},
                                 {"microns", 0.001F},
                                 {"micrometer", 0.001F},
                                 {"micrometres", 0.001F},
                                 {"\xC2\xB5m", 0.001F},
                                 {"\xCE\xBCm", 0.001F}}) {
    Parts parts;
    parts.info += "obj_info unit " + std::string(unit) + "\n";
    EXPECT_FLOAT_EQ(grid_of(parts.text()).x[1], mm) << unit;
  }
  for (const char* unit : {"milli", "mms", "s", "ounce", "meterss"}) {
    Parts parts;
    parts.info += "obj_info unit " + std::string(unit) + "\n";
    EXPECT_THAT(line(parts), HasSubstr("not m, cm, mm, um or in")) << unit;
  }
}

TEST(PlyScan, AByteOrderMarkIsPassedOver) {
  const auto scans = read_scan_bytes("\xEF\xBB\xBF" + Parts().text(), "a.ply");
  ASSERT_TRUE(scans) << line_of(scans);
  expect_the_grid(std::get<RangeGrid>(scans->front()));
}

TEST(PlyScan, AnIndexOfMinusOneIsNoReturn) {
  Parts parts;
  parts.body = "0 0 0\n1 0 0.5\n0 1 0\n1 1 0\n1 0\n1 1\n1 -1\n1 2\n1 -1\n1 3\n";
  expect_the_grid(grid_of(parts.text()));
}

TEST(PlyScan, WhatOldPrintfWroteForNoNumberIsNoReturn) {
  Parts parts;
  parts.grid.clear();
  parts.vertex.replace(parts.vertex.find('4'), 1, "6");
  parts.body =
      "0 0 0\n1 0 0.5\n1.#QNAN 1.#QNAN 1.#QNAN\n0 1 0\n-1.#IND -1.#IND -1.#IND\n-nan(ind) 1 1.#INF\n";
  EXPECT_EQ(grid_of(parts.text()).valid, (std::vector<std::uint8_t>{0, 1, 0, 1, 0, 0}));
}

TEST(PlyScan, ASpacingThatTheSamplesContradictIsMeasuredAndTold) {
  Parts parts;
  std::vector<std::string> told;
  const GridReadOptions options{.remark = [&](const std::string& scan, const std::string& remark) {
    told.push_back(scan + ": " + remark);
  }};
  parts.info += "obj_info dubsar_spacing_mm 1.2\n";
  EXPECT_EQ(grid_of(parts.text(), options).spacing_mm, 1.2);
  EXPECT_TRUE(told.empty());
  for (const char* said : {"15 ", "0.2"}) {
    parts.info.replace(parts.info.find("_mm ") + 4, 3, said);
    EXPECT_FLOAT_EQ(static_cast<float>(grid_of(parts.text(), options).spacing_mm), 1.0F);
  }
  ASSERT_EQ(told.size(), 2U);
  EXPECT_THAT(told[0],
              HasSubstr("a.ply: its header says a spacing of 15 mm, but its samples lie 1 mm apart"));
  EXPECT_THAT(told[1], HasSubstr("mend or remove `obj_info dubsar_spacing_mm`"));
}

TEST(PlyScan, CoordinatesOfAMapAreNotBlurredSilently) {
  const auto moved = [](const std::string& by) {
    Parts parts;
    const std::string x0 = by + "00";
    const std::string x1 = by + "01";
    parts.body = x0 + " 0 0\n" + x1 + " 0 0.5\n" + x0 + " 1 0\n" + x1 + " 1 0\n1 0\n1 1\n0\n1 2\n0\n1 3\n";
    return parts;
  };
  EXPECT_TRUE(read_scan_bytes(moved("1000").text(), "a.ply"));
  EXPECT_TRUE(read_scan_bytes(moved("9000").text(), "a.ply", {.mm_per_unit = 1.0}))
      << "1 mm is coarse enough";
  EXPECT_TRUE(read_scan_bytes(moved("9000").text(), "a.ply", {.mm_per_unit = 0.1}));
  EXPECT_THAT(line(moved("50000")),
              HasSubstr("a.ply: lies beyond 1 km from the origin (4 samples); export it without the offset"));
  RangeGrid fine;
  fine.allocate(20, 20);
  fine.spacing_mm = 0.1;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    fine.x[i] = 900000.0F + static_cast<float>(0.1 * fine.col_of(i));
    fine.y[i] = static_cast<float>(0.1 * fine.row_of(i));
    fine.valid[i] = 1;
  }
  EXPECT_THAT(line_of(read_scan_bytes(encode_grid_ply(fine), "b.ply")),
              HasSubstr("b.ply: lies 900 m from the origin, too far"));
}

TEST(PlyScan, ReadsIntensityColourAndConfidence) {
  Parts parts;
  parts.vertex +=
      "property uchar intensity\nproperty float confidence\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\n";
  parts.body =
      "0 0 0 255 0.5 1 2 3\n1 0 0 51 7 4 5 6\n0 1 0 0 nan 7 8 9\n1 1 0 0 -1 0 0 0\n1 0\n1 1\n0\n1 2\n0\n1 "
      "3\n";
  const RangeGrid grid = grid_of(parts.text());
  EXPECT_FLOAT_EQ(grid.intensity[0], 1.0F);
  EXPECT_FLOAT_EQ(grid.intensity[1], 0.2F);
  EXPECT_EQ(grid.confidence[0], 0.5F);
  EXPECT_EQ(grid.confidence[1], 1.0F);
  EXPECT_EQ(grid.confidence[3], 0.0F);
  EXPECT_EQ(grid.rgb[5], 6);
}

TEST(PlyScan, ReadsConfidenceOfWholeNumbersByTheirType) {
  const auto confidence = [](const std::string& type, const std::string& best, const std::string& half) {
    Parts parts;
    parts.vertex += "property " + type + " confidence\n";
    parts.body = "0 0 0 " + best + "\n1 0 0 " + half + "\n0 1 0 0\n1 1 0 0\n1 0\n1 1\n0\n1 2\n0\n1 3\n";
    const RangeGrid grid = grid_of(parts.text());
    return std::pair(grid.confidence[0], grid.confidence[1]);
  };
  EXPECT_EQ(confidence("uchar", "255", "51"), std::pair(1.0F, 0.2F));
  EXPECT_EQ(confidence("ushort", "65535", "13107"), std::pair(1.0F, 0.2F));
  EXPECT_EQ(confidence("uchar", "1", "0"), std::pair(1.0F, 0.0F));  // a mask
}

TEST(PlyScan, ReadsColoursAsMeshesHaveThem) {
  const auto colours = [](const std::string& type, const std::string& first, const std::string& last) {
    Parts parts;
    for (const char* name : {"red", "green", "blue"}) {
      parts.vertex += "property " + type + " " + name + "\n";
    }
    parts.body =
        "0 0 0 " + first + "\n1 0 0 0 0 0\n0 1 0 0 0 0\n1 1 0 " + last + "\n1 0\n1 1\n0\n1 2\n0\n1 3\n";
    const std::vector<std::uint8_t> rgb = grid_of(parts.text()).rgb;
    return std::vector<std::uint8_t>(rgb.begin(), rgb.begin() + 3);
  };
  EXPECT_EQ(colours("float", "1 0.5 0.003922", "1.2 0 0"), (std::vector<std::uint8_t>{255, 128, 1}));
  EXPECT_EQ(colours("float", "1 20.4 255", "0 0 0"), (std::vector<std::uint8_t>{1, 20, 255}));
  EXPECT_EQ(colours("float", "1 0.4 0", "0 0 2"), (std::vector<std::uint8_t>{1, 0, 0}));
  EXPECT_EQ(colours("ushort", "65535 257 32768", "0 0 0"), (std::vector<std::uint8_t>{255, 1, 128}));
  EXPECT_EQ(colours("uchar", "1 2 3", "0 0 0"), (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST(PlyScan, CoordinatesThatAreNoMeasurementAreNoReturns) {
  for (const char* bad : {"nan", "inf", "-inf", "1e30", "1e999", "-2e6"}) {
    Parts parts;
    parts.body.replace(parts.body.find("0.5"), 3, bad);
    EXPECT_EQ(grid_of(parts.text()).valid, (std::vector<std::uint8_t>{1, 0, 0, 1, 0, 1})) << bad;
  }
  Parts tiny;
  tiny.body.replace(tiny.body.find("0.5"), 3, "1e-999");
  EXPECT_EQ(grid_of(tiny.text()).point(1), Eigen::Vector3f(1, 0, 0));
}

TEST(PlyScan, ReadsOrderedVerticesWithoutARangeGrid) {
  Parts parts;
  parts.vertex.replace(15, 1, "6");
  parts.grid.clear();
  parts.body = "5 0 0\n1 0 0.5\n0 0 0\n0 1 0\nnan nan nan\n1 1 0\n";
  const RangeGrid grid = grid_of(parts.text());
  EXPECT_EQ(grid.rows, 2);
  EXPECT_EQ(grid.valid, (std::vector<std::uint8_t>{1, 1, 0, 1, 0, 1}));
}

TEST(PlyScan, ReadsPointsWithoutAnOrder) {
  Parts parts;
  parts.info.clear();
  parts.grid = "element face 0\nproperty list uchar int vertex_indices\n";
  parts.body = "0 0 0\n1 0 0.5\nnan 1 0\n1 1 0\n";
  const auto scans = read_scan_bytes(parts.text(), "a.ply");
  ASSERT_TRUE(scans) << line_of(scans);
  const auto& cloud = std::get<PointCloud>(scans->front());
  ASSERT_EQ(cloud.points.size(), 3U);
  EXPECT_EQ(cloud.points[2], Eigen::Vector3f(1, 1, 0));
  parts.grid.replace(13, 1, "1");
  parts.body += "3 0 1 2\n";
  EXPECT_THAT(line(parts), HasSubstr("a mesh with faces, not a scan"));
}

TEST(PlyScanHostile, EmptyTruncatedOrMislabelled) {
  EXPECT_THAT(line_of(read_scan_bytes("", "a.ply")), HasSubstr("a.ply: the file is empty; copy"));
  EXPECT_THAT(line_of(read_scan_bytes("\xff\xd8\xff\xe0JFIF", "a.ply")), HasSubstr("a.ply: not a PLY file"));
  EXPECT_THAT(line_of(read_scan_bytes("ply\nformat ascii 1.0\n", "a.ply")),
              HasSubstr("ends within its PLY header"));
  EXPECT_THAT(line_of(read_scan_bytes("x", "a.doc")),
              HasSubstr("a.doc: not a scan that Dubsar reads; give "));
  EXPECT_THAT(line_of(read_scan_bytes("0 0 0\n", "a.CSV")),
              HasSubstr("; rename .csv to .xyz where the lines"));
  EXPECT_THAT(line_of(read_scan_bytes("PK", "scans.zip")), HasSubstr("; unpack the packed files"));
  Parts parts;
  parts.body.resize(10);
  EXPECT_THAT(line(parts), HasSubstr("claims 4 of element vertex, but only 10 bytes are left"));
  parts = {};
  parts.body = "0 0 0\n1 0 0.5000000000000000000000000000\n0";
  EXPECT_THAT(line(parts), HasSubstr("a.ply: ends within vertex 2 of 4; the file is cut short"));
}

TEST(PlyScanHostile, EveryTruncationOfABinaryFileIsAnError) {
  const std::string whole = binary_text(std::endian::big);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read_scan_bytes(std::string_view(whole).substr(0, size), "a.ply")) << size;
  }
}

TEST(PlyScanHostile, HugeNegativeAndMissingCounts) {
  Parts parts;
  parts.vertex.replace(15, 1, "4000000000000000000");
  EXPECT_THAT(line(parts), HasSubstr("claims 4000000000000000000"));
  parts.vertex.replace(15, 19, "-4");
  EXPECT_THAT(line(parts), HasSubstr("header line 5: element 'vertex' has the negative count -4"));
  parts.vertex.replace(15, 2, "four");
  EXPECT_THAT(line(parts), HasSubstr("header line 5: element 'vertex' has no count but 'four'"));
  parts.vertex.replace(15, 4, "99999999999999999999999");
  EXPECT_THAT(line(parts), HasSubstr("has no count but"));
  parts = {};
  parts.info = "obj_info num_cols 2000000000\nobj_info num_rows 2000000000\n";
  EXPECT_THAT(line(parts), HasSubstr("obj_info num_rows is '2000000000', not a whole number from 1 to"));
  parts.info = "obj_info num_cols -3\nobj_info num_rows -2\n";
  EXPECT_THAT(line(parts), HasSubstr("obj_info num_rows is '-2'"));
}

TEST(PlyScanHostile, AListThatClaimsMoreThanTheFile) {
  std::string text = binary_text(std::endian::little);
  const std::size_t list = text.find("ab") - 2;
  text[list] = '\xff';
  text[list + 1] = '\xff';
  EXPECT_THAT(line_of(read_scan_bytes(text, "a.ply")), HasSubstr("ends within vertex 0 of 4"));
}

TEST(PlyScanHostile, IndicesThatAreWrong) {
  Parts parts;
  parts.body.replace(parts.body.find("1 3\n"), 3, "1 4");
  EXPECT_THAT(line(parts), HasSubstr("range_grid 5 (line 21): vertex index 4 is not one of the 4 vertices"));
  parts.body.replace(parts.body.find("1 4\n"), 3, "1 -2");
  EXPECT_THAT(line(parts), HasSubstr("vertex index -2 is not one of"));
  parts.body.replace(parts.body.find("1 -2\n"), 4, "1 nan");
  EXPECT_THAT(line(parts), HasSubstr("vertex index nan is not one of"));
  parts.body.replace(parts.body.find("1 nan\n"), 5, "1 2.5");
  EXPECT_THAT(line(parts), HasSubstr("vertex index 2.5 is not one of"));
  parts.body.replace(parts.body.find("1 2.5\n"), 5, "1 2");
  EXPECT_THAT(line(parts), HasSubstr("range_grid 5 (line 21): vertex 2 already stands in another cell"));
  parts.body.replace(parts.body.rfind("1 2\n"), 3, "2 2 3");
  EXPECT_THAT(line(parts), HasSubstr("holds 2 vertices, not one or none"));
}

TEST(PlyScanHostile, ARangeGridThatDisagreesWithItsInfo) {
  Parts parts;
  parts.info = "obj_info num_cols 4\nobj_info num_rows 2\n";
  EXPECT_THAT(line(parts), HasSubstr("obj_info says 2 x 4 cells, but its range_grid has 6; export"));
  parts.info = "obj_info num_cols 4\n";
  EXPECT_THAT(line(parts), HasSubstr("has a range_grid but no obj_info num_rows and num_cols"));
  parts = {};
  parts.grid = "element range_grid 6\nproperty int vertex_index\n";
  EXPECT_THAT(line(parts), HasSubstr("range_grid element has no list of vertex indices"));
}

TEST(PlyScanHostile, AbsurdHeaders) {
  const auto with = [](const std::string& extra) {
    Parts parts;
    parts.info += extra;
    return line(parts);
  };
  EXPECT_THAT(with("property float q\n"), HasSubstr("header line 5: a property stands before any element"));
  EXPECT_THAT(with("element a 0\nproperty quad q\n"),
              HasSubstr("header line 6: property type 'quad' is not known"));
  EXPECT_THAT(with("element a 0\nproperty list float int q\n"), HasSubstr("list length type 'float'"));
  EXPECT_THAT(with("element a 0\nproperty float\n"), HasSubstr("a property has no name"));
  EXPECT_THAT(with("element a 3\n"), HasSubstr("element a has no properties"));
  EXPECT_THAT(with("element vertex 1\n"), HasSubstr("element 'vertex' stands twice"));
  EXPECT_THAT(with(std::string(2 << 20, 'x')), HasSubstr("no end_header in the first 1048576 bytes"));
  std::string many;
  for (int i = 0; i < 100; ++i) {
    many += "element e" + std::to_string(i) + " 0\n";
  }
  EXPECT_THAT(with(many), HasSubstr("more than 64 elements"));
  EXPECT_THAT(with("obj_info dubsar_laser_mm 1 2\n"),
              HasSubstr("obj_info dubsar_laser_mm is not three numbers"));
  Parts parts;
  parts.format = "binary_middle_endian";
  EXPECT_THAT(line(parts), HasSubstr("format 'binary_middle_endian' is not known"));
}

TEST(PlyScanHostile, MissingCoordinatesAndWords) {
  Parts parts;
  parts.vertex = "element vertex 4\nproperty float x\nproperty float q\nproperty float z\n";
  EXPECT_THAT(line(parts), HasSubstr("a.ply: its vertices have no y; export the scan again"));
  parts = {};
  parts.vertex = "element point 4\nproperty float x\n";
  EXPECT_THAT(line(parts), HasSubstr("a PLY file without vertices"));
  parts = {};
  parts.body.replace(parts.body.find("0.5"), 3, "0,5");
  EXPECT_THAT(line(parts), HasSubstr("vertex 1 (line 13): '0,5' is not what belongs here"));
  parts.body = "nan 0 0\nnan 0 0.5\nnan 1 0\nnan 1 0\n1 0\n1 1\n0\n1 2\n0\n1 3\n";
  EXPECT_THAT(line(parts), HasSubstr("holds no usable sample"));
}

}  // namespace
}  // namespace dubsar
