// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/text_scans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "formats/atomic_file.h"
#include "formats/text_scanner.h"

#include "tests/formats/format_support.h"
#include "tests/support/comma_locale.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::ScratchFolder;

/// Two profiles of three samples.
const std::string kPtx =
    "2\n3\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n"
    "0.0 0.1 -5 0.5 255 0 7\n0 0 0 0.5 0 0 0\n0.0 0.3 -5 0.25 1 2 3\n"
    "0.1 0.1 -5 1 4 5 6\n0.1 0.2 -5 0 7 8 9\nnan 0.3 -5 0 0 0 0\n";

TEST(Ptx, ReadsOneScanInTheScannersFrame) {
  const auto scans = read_scan_bytes(kPtx, "dir/a.ptx", {.mm_per_unit = 1000.0});
  ASSERT_TRUE(scans) << line_of(scans);
  ASSERT_EQ(scans->size(), 1U);
  const auto& grid = std::get<RangeGrid>(scans->front());
  EXPECT_EQ(grid.rows, 2);
  EXPECT_EQ(grid.cols, 3);
  EXPECT_EQ(grid.valid, (std::vector<std::uint8_t>{1, 0, 1, 1, 1, 0}));
  EXPECT_EQ(grid.point(4), Eigen::Vector3f(100, 200, -5000));
  EXPECT_FLOAT_EQ(grid.intensity[2], 0.25F);
  EXPECT_EQ(grid.rgb[0], 255);
  EXPECT_EQ(grid.rgb[14], 9);
  EXPECT_EQ(grid.view.camera_mm, Eigen::Vector3d(0, 0, 0));
  EXPECT_LT(grid.view.direction.z(), -0.99);
  EXPECT_NEAR(grid.spacing_mm, 100, 0.01);
  EXPECT_EQ(grid.source, "a.ptx");
}

TEST(ScanReading, EndsSoonAfterItIsStopped) {
  JobContext job;
  job.cancel();
  std::string lines;
  for (int k = 0; k < 5000; ++k) {
    lines += std::to_string(k) + " 0.5 1\n";
  }
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n1 2 3\n";
  std::string commas = kPtx;
  std::ranges::replace(commas, '.', ',');
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.ptx", kPtx},
                                    {"commas.ptx", commas},
                                    {"a.xyz", lines},
                                    {"a.ply", ply}}) {
    const auto stopped = read_scan_bytes(bytes, name, {.job = &job});
    ASSERT_FALSE(stopped) << name;
    EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled) << name << ": " << line_of(stopped);
    EXPECT_TRUE(read_scan_bytes(bytes, name)) << name;
  }
  // Also while its bytes are fetched, of which nothing is looked at.
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "b.xyz", std::string_view("1 2 3\n")));
  const auto stopped = read_scan_file(folder / "b.xyz", {.job = &job});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled) << line_of(stopped);
  EXPECT_TRUE(read_scan_file(folder / "b.xyz"));
}

TEST(Ptx, ReadsSeveralScansAndCountsThem) {
  const ScratchFolder folder;
  std::string crlf;
  for (const char c : kPtx + kPtx) {
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
  }
  ASSERT_TRUE(write_file_atomically(folder / "two.ptx", crlf));
  EXPECT_TRUE(looks_like_scan(folder / "two.ptx"));
  EXPECT_EQ(count_scans(folder / "two.ptx").value(), 2);
  const auto scans = read_scan_file(folder / "two.ptx");
  ASSERT_TRUE(scans) << line_of(scans);
  ASSERT_EQ(scans->size(), 2U);
  EXPECT_EQ(std::get<RangeGrid>((*scans)[1]).source, "two.ptx#1");
}

const std::string kPose = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

/// In a tenth of a second: were something done for each scan that goes through the file from its beginning,
/// in a minute.
TEST(Ptx, ManyScansTakeNoLongerEach) {
  std::string many;
  for (int scan = 0; scan < 50000; ++scan) {
    many += "0\n0\n" + kPose;
  }
  many += kPtx;
  const auto scans = read_scan_bytes(many, "many.ptx");
  ASSERT_TRUE(scans) << line_of(scans);
  EXPECT_EQ(scans->size(), 1U);
  EXPECT_EQ(std::get<RangeGrid>(scans->front()).source, "many.ptx#50000");
}

TEST(Ptx, ANoReturnMayLeaveOutWhatFollows) {
  const auto scans = read_scan_bytes("1\n6\n" + kPose +
                                         "0 0 0 0\n0 0 0\n0 0.3 -5 0.5 9 8 7\n\n0 0 0\nnan nan nan\n"
                                         "0 0.6 -5 0.25 1 2 3\n",
                                     "a.ptx");
  ASSERT_TRUE(scans) << line_of(scans);
  const auto& grid = std::get<RangeGrid>(scans->front());
  EXPECT_EQ(grid.valid, (std::vector<std::uint8_t>{0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(grid.point(2), Eigen::Vector3f(0, 0.3F, -5));
  EXPECT_EQ(grid.intensity, (std::vector<float>{0, 0, 0.5F, 0, 0, 0.25F}));
  EXPECT_EQ(grid.rgb[6], 9);
  EXPECT_EQ(grid.rgb[17], 3);
}

TEST(Ptx, ALineThatDoesNotFitIsNamed) {
  const auto line = [](const std::string& samples) {
    return line_of(read_scan_bytes("1\n3\n" + kPose + samples, "a.ptx"));
  };
  const std::string good = "0 1 -5 0.5\n";
  EXPECT_THAT(line(good + "0 2 -5\n" + good), HasSubstr("line 12: has 3 numbers where 4 belong"));
  EXPECT_THAT(line(good + "0 0 0 0 0\n" + good), HasSubstr("line 12: has 5 numbers where 4 belong"));
  EXPECT_THAT(line(good + "0 0\n0 0\n" + good), HasSubstr("line 12: has 2 numbers where 4 belong"));
  EXPECT_THAT(line(good + good + "0 2 -5\n"), HasSubstr("ends at sample 2 of 3"));
  EXPECT_THAT(line("0 1 -5 0.5 3\n" + good + good),
              HasSubstr("line 11: a sample has 5 numbers, not 3, 4, 6 or 7"));
  // The header of the next scan is no sample.
  EXPECT_THAT(line(good + good + "1\n2\n" + kPose + good + good),
              HasSubstr("line 13: has 1 numbers where 4 belong"));
}

TEST(Ptx, SixColumnsAreAColourWhereTheyCanBe) {
  const auto scans = read_scan_bytes("1\n2\n" + kPose + "0 0.1 -5 10 20 30\n0 0.2 -5 255 0 1\n", "a.ptx");
  ASSERT_TRUE(scans) << line_of(scans);
  const auto& grid = std::get<RangeGrid>(scans->front());
  EXPECT_EQ(grid.rgb, (std::vector<std::uint8_t>{10, 20, 30, 255, 0, 1}));
  EXPECT_TRUE(grid.intensity.empty());
  EXPECT_THAT(line_of(read_scan_bytes("1\n1\n" + kPose + "0 0.1 -5 0 0.6 -0.8\n", "a.ptx")),
              HasSubstr("line 11: the last three of its 6 numbers are no colour"));
}

TEST(Ptx, AScanOfNoSamplesAmongOthersIsPassedOverWithAWord) {
  const ScratchFolder folder;
  std::string told;
  const std::string empty = "0\n0\n" + kPose;
  const std::string text = kPtx + empty + kPtx;
  const auto scans = read_scan_bytes(
      text, "a.ptx",
      {.remark = [&](const std::string& scan, const std::string& remark) { told += scan + ": " + remark; }});
  ASSERT_TRUE(scans) << line_of(scans);
  ASSERT_EQ(scans->size(), 2U);
  EXPECT_EQ(std::get<RangeGrid>((*scans)[1]).source, "a.ptx#2");
  EXPECT_EQ(told, "a.ptx#0: a.ptx#1 beside it has no samples and is passed over");
  ASSERT_TRUE(write_file_atomically(folder / "a.ptx", text));
  EXPECT_EQ(count_scans(folder / "a.ptx").value(), 2);
  EXPECT_THAT(line_of(read_scan_bytes(empty, "a.ptx")), HasSubstr("holds no usable sample"));
}

TEST(Ptx, DecimalCommasAreReadWhereNothingElseCanBeMeant) {
  std::string with_commas = kPtx;
  std::ranges::replace(with_commas, '.', ',');
  const auto points = read_scan_bytes(kPtx, "a.ptx");
  const auto commas = read_scan_bytes(with_commas, "a.ptx");
  ASSERT_TRUE(points && commas) << line_of(commas);
  EXPECT_EQ(std::get<RangeGrid>(commas->front()).y, std::get<RangeGrid>(points->front()).y);
  EXPECT_THAT(line_of(read_scan_bytes(with_commas + kPtx, "a.ptx")),
              HasSubstr("line 11: its numbers have commas, and decimal points stand in the file as well"));
  EXPECT_THAT(line_of(read_scan_bytes("1\n1\n" + kPose + "0, 1, 2\n", "a.ptx")),
              HasSubstr("line 11: a comma stands where none belongs in PTX"));
}

TEST(Ptx, ByteOrderMarkAndOldLineEndsAreNoObstacle) {
  std::string old = kPtx;
  std::ranges::replace(old, '\n', '\r');
  for (const std::string& text : {"\xEF\xBB\xBF" + kPtx, old}) {
    const auto scans = read_scan_bytes(text, "a.ptx");
    ASSERT_TRUE(scans) << line_of(scans);
    EXPECT_EQ(std::get<RangeGrid>(scans->front()).valid_count(), 4U);
  }
}

/// A dome as PTX, its top at (0, 0, top_mm), turned about that by `turn`.
std::string dome_ptx(double top_mm, bool with_outline,
                     const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  constexpr int kSide = 60;
  std::string text = std::to_string(kSide) + "\n" + std::to_string(kSide) +
                     "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const double x = col - 0.5 * kSide + 0.25;
      const double y = row - 0.5 * kSide + 0.25;
      const double square = 1 - (x * x + y * y) / 676;
      const double z = with_outline ? 12 * std::sqrt(std::max(0.0, square)) - 12 : -0.01 * x * x;
      const Eigen::Vector3d p = turn * Eigen::Vector3d(x, y, z) + Eigen::Vector3d(0, 0, top_mm);
      text += with_outline && square <= 0
                  ? std::string("0 0 0\n")
                  : std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    }
  }
  return text;
}

TEST(Ptx, AnObjectAtTheOriginIsNotSeenFromWithinItself) {
  std::string told;
  const GridReadOptions options{
      .remark = [&](const std::string& scan, const std::string& remark) { told += scan + ": " + remark; }};
  const auto proper = read_scan_bytes(dome_ptx(-100, true), "a.ptx", options);
  ASSERT_TRUE(proper) << line_of(proper);
  EXPECT_EQ(std::get<RangeGrid>(proper->front()).view.camera_mm, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(told, "");
  for (const double top_mm : {3.0, 12.0}) {
    told.clear();
    const auto centred = read_scan_bytes(dome_ptx(top_mm, true), "a.ptx", options);
    ASSERT_TRUE(centred) << line_of(centred);
    const auto& grid = std::get<RangeGrid>(centred->front());
    EXPECT_EQ(grid.view.direction, Eigen::Vector3d(0, 0, -1));
    EXPECT_FALSE(grid.view.camera_mm);
    EXPECT_FALSE(grid.view.laser_mm);
    EXPECT_THAT(told, HasSubstr("a.ptx: the scanner would stand at 0 0 0, in the scanned surface"));
  }
  EXPECT_THAT(line_of(read_scan_bytes(dome_ptx(3, false), "a.ptx")),
              HasSubstr("a.ptx: the scanner's position 0 0 0 lies in the scanned surface"));
}

TEST(Ptx, AScanThatWasMovedAwayFromItsScannerIsNotSeenFromTheOrigin) {
  for (const double turn_rad : {1.2, std::numbers::pi}) {
    std::string told;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix();
    const auto scans = read_scan_bytes(dome_ptx(-200, true, turn), "a.ptx",
                                       {.remark = [&](const std::string& scan, const std::string& remark) {
                                         told += scan + ": " + remark;
                                       }});
    ASSERT_TRUE(scans) << line_of(scans);
    const auto& grid = std::get<RangeGrid>(scans->front());
    EXPECT_LT((grid.view.direction - turn * Eigen::Vector3d(0, 0, -1)).norm(), 0.03) << turn_rad;
    EXPECT_FALSE(grid.view.camera_mm);
    EXPECT_THAT(told, HasSubstr("a.ptx: the scanner would stand at 0 0 0, but its rows and columns"));
  }
}

TEST(Ptx, CoordinatesOfAMapAreNamed) {
  EXPECT_THAT(line_of(read_scan_bytes(dome_ptx(5e6, true), "a.ptx")),
              HasSubstr("a.ptx: lies beyond 1 km from the origin"));
  EXPECT_THAT(line_of(read_scan_bytes("5000000 5000000 1\n5000001 5000000 2\n", "a.xyz")),
              HasSubstr("a.xyz: lies beyond 1 km from the origin (2 samples)"));
}

TEST(Ptx, NamesWhatIsWrong) {
  const auto line = [](const std::string& text) { return line_of(read_scan_bytes(text, "a.ptx")); };
  EXPECT_THAT(line(""), HasSubstr("a.ptx: the file is empty"));
  EXPECT_THAT(line(" \n"), HasSubstr("a.ptx: line 2: '' stands where a count"));
  EXPECT_THAT(line("-4\n3\n"), HasSubstr("line 1: '-4' stands where a count from 1 to 16777216 belongs"));
  EXPECT_THAT(line("2\nx\n"), HasSubstr("line 2: 'x' stands where a count"));
  EXPECT_THAT(line("2\n3\n1 2 oops"), HasSubstr("line 3: 'oops' stands where the scanner's pose belongs"));
  std::string huge = kPtx;
  huge.replace(0, 1, "9999999");
  EXPECT_THAT(line(huge), HasSubstr("claims 9999999 x 3 samples, but only"));
  EXPECT_THAT(line(kPtx.substr(0, kPtx.size() - 20)), HasSubstr("ends at sample 5 of 6"));
  std::string bad = kPtx;
  bad.replace(bad.find("0.25"), 4, "0.2x");
  EXPECT_THAT(line(bad), HasSubstr("line 13: sample 2: '0.2x' is not a number"));
}

PointCloud read_cloud(const std::string& text) {
  const auto scans = read_scan_bytes(text, "a.xyz");
  EXPECT_TRUE(scans) << line_of(scans);
  return scans ? std::get<PointCloud>(scans->front()) : PointCloud{};
}

TEST(PointText, ReadsPlainPoints) {
  const PointCloud cloud = read_cloud("# a comment\n1 2 3\n\n 4,5;6\r\n+7\t8e0 9 # end\ninf 0 0\n");
  ASSERT_EQ(cloud.points.size(), 3U);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(cloud.points[2], Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(cloud.source, "a.xyz");
  EXPECT_TRUE(cloud.intensity.empty());
}

TEST(PointText, ReadsColumnsForWhatTheyAre) {
  EXPECT_EQ(read_cloud("2\n1 2 3 255\n1 2 4 51\n").intensity, (std::vector<float>{1.0F, 0.2F}));
  EXPECT_EQ(read_cloud("x y z r g b\n1 2 3 10 20 30\n").rgb, (std::vector<std::uint8_t>{10, 20, 30}));
  const PointCloud normals = read_cloud("1 2 3 0 0.6 -0.8\n1 2 4 0 0 1\n");
  ASSERT_EQ(normals.normals.size(), 2U);
  EXPECT_NEAR(normals.normals[0].z(), -0.8F, 1e-6);
  const PointCloud all = read_cloud("1 2 3 0.5 10 20 30\n");
  EXPECT_EQ(all.intensity, (std::vector<float>{0.5F}));
  EXPECT_EQ(all.rgb.size(), 3U);
}

TEST(PointText, LinesMayEndAsOnAnOldMacintosh) {
  const PointCloud cloud = read_cloud("x y z i\r1 2 3 255\r\r4 5 6 51\r");
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(cloud.intensity, (std::vector<float>{1.0F, 0.2F}));
  EXPECT_EQ(read_cloud("1,5 2,5 3,5\r4,5 5,5 6,5\r").points[1], Eigen::Vector3f(4.5F, 5.5F, 6.5F));
  EXPECT_THAT(line_of(read_scan_bytes("1 2 3\r4 5\r", "a.xyz")),
              HasSubstr("line 2: has 2 numbers where 3 belong"));
  std::string many;
  for (std::size_t k = 0; k < kLeastPointLines; ++k) {
    many += "1 2 3\r";
  }
  EXPECT_EQ(kind_of_head(many, true, "a.txt"), FileKind::kScan);
}

TEST(PointText, NamesWhatIsWrong) {
  const auto line = [](const std::string& text) { return line_of(read_scan_bytes(text, "a.xyz")); };
  EXPECT_THAT(line(""), HasSubstr("a.xyz: the file is empty"));
  EXPECT_THAT(line("1 2 3\n4 5\n"), HasSubstr("line 2: has 2 numbers where 3 belong"));
  EXPECT_THAT(line("1 2 3\n4 5 six\n"), HasSubstr("line 2: 'six' is not a number"));
  EXPECT_THAT(line("just words\n"), HasSubstr("holds no usable point"));
  EXPECT_THAT(line("nan nan nan\n"), HasSubstr("holds no usable point"));
}

TEST(PointText, DecimalCommasAreTold) {
  const auto points = [](const std::string& text) { return read_cloud(text).points; };
  const std::vector<Eigen::Vector3f> wanted{{-64.5F, 36.25F, 40}, {1, 2, 3.5F}};
  EXPECT_EQ(points("-64,50 36,25 40,0\n1,0 2,0 3,5\n"), wanted);
  EXPECT_EQ(points("x;y;z\n-64,50;36,25;40,0\n1,0;2,0;3,5\n"), wanted);
  // Zeros behind the comma may be left out, even before a line that tells.
  EXPECT_EQ(points("-64,5\t36,25\t40\n1,0\t2,0\t3,5\n"), wanted);
  const PointCloud coloured = read_cloud("-64,5 36,25 40,0 10 20 30\n1,0 2,0 3,5 1 2 255\n");
  EXPECT_EQ(coloured.points, wanted);
  EXPECT_EQ(coloured.rgb, (std::vector<std::uint8_t>{10, 20, 30, 1, 2, 255}));
  // Commas between numbers.
  const std::vector<Eigen::Vector3f> whole{{1, 2, 3}, {4, 5, 6}};
  for (const char* text : {"1,2,3\n4,5,6\n", "1, 2, 3\n4, 5, 6\n", "1 ,2 ,3\n4,5;6\n", "1,2 3\n4 5,6\n",
                           "x,y,z\n1.0,2.0,3.0\n4.0,5.0,6.0\n"}) {
    EXPECT_EQ(points(text), whole) << text;
  }
}

TEST(PointText, ACommaBesideNumbersWithPointsIsASeparator) {
  const auto points = [](const std::string& text) {
    const Result<std::vector<ScanData>> read = read_scan_bytes(text, "a.xyz");
    return read ? std::get<PointCloud>(read->front()).points : std::vector<Eigen::Vector3f>{};
  };
  const auto plain = points("0.1 0.2 1.05 128\n0.3 0.2 1.25 7\n0.3 0.4 1.5 9\n");
  ASSERT_EQ(plain.size(), 3U);
  EXPECT_EQ(points("0.1 0.2 1.05,128\n0.3 0.2 1.25,7\n0.3 0.4 1.5,9\n"), plain);
}

TEST(PointText, CommasThatMayBeEitherAreRefused) {
  const auto line = [](const std::string& text) { return line_of(read_scan_bytes(text, "a.xyz")); };
  EXPECT_THAT(
      line("1 2 3\n4 5,6 7\n"),
      HasSubstr("line 2: nothing tells whether its commas stand in numbers or between them; export the "
                "points with decimal points"));
  EXPECT_THAT(line("1,234.5 2,345.5 3,456.5\n"), HasSubstr("line 1: nothing tells"));
  EXPECT_THAT(line("1,5 2,5 3,5\n1,2,3\n"),
              HasSubstr("line 2: its commas stand between numbers, those of other lines in them"));
  EXPECT_THAT(line("1,2,3\n1,5 2,5 3,5\n"),
              HasSubstr("line 2: its commas stand in numbers, those of other lines between them"));
}

TEST(PointText, WhatOldPrintfWroteForNoNumberIsNoReturn) {
  const PointCloud cloud = read_cloud(
      "4 5 6\n1.#QNAN 1.#QNAN0 1.#QNAN\n-1.#IND 0 0\n1.#INF00 0 0\n-nan(ind) nan(0x8) NaN(snan)\n");
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(4, 5, 6));
  EXPECT_THAT(line_of(read_scan_bytes("4 5 6\n1 2 1#QNAN\n", "a.xyz")),
              HasSubstr("line 2: '1#QNAN' is not a number"));
}

TEST(TextScanner, NumbersThatNoDoubleHoldsAreZeroOrInfinityWhateverTheHostsLocale) {
  const auto read = [](std::string_view word) {
    double value = -1;
    EXPECT_TRUE(parse_number(word, value)) << word;
    return value;
  };
  const auto all = [&] {
    EXPECT_EQ(read("1.5e-400"), 0);
    EXPECT_EQ(read("0.5e999"), std::numeric_limits<double>::infinity());
    EXPECT_EQ(read("-2.5e999"), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(read("2.5e-5"), 2.5e-5);
  };
  all();
  const test::CommaLocale comma;
  all();
}

TEST(PointText, ColoursRunTo255OrToOne) {
  for (const std::string text : {"0 0 0 1 0.2 0\n1 0 0 0.6 0 0\n0 1 0 0 0.4 0.8\n",
                                 "0 0 0 255 51 0\n1 0 0 153 0 0\n0 1 0 0 102 204\n"}) {
    const auto data = read_scan_bytes(text, "a.xyz");
    ASSERT_TRUE(data) << line_of(data);
    EXPECT_EQ(std::get<PointCloud>(data->front()).rgb,
              (std::vector<std::uint8_t>{255, 51, 0, 153, 0, 0, 0, 102, 204}));
  }
  const auto normals = read_scan_bytes("0 0 0 0 0 1\n1 0 0 0 0.6 0.8\n0 1 0 1 0 0\n", "a.xyz");
  ASSERT_TRUE(normals) << line_of(normals);
  EXPECT_TRUE(std::get<PointCloud>(normals->front()).rgb.empty());
}

}  // namespace
}  // namespace dubsar
