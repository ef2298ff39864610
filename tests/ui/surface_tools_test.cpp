// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What clicks on a surface do: cuts that are measured, polygons that select, pictures to scale.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_mesh.h"
#include "tests/ui/support/read_png.h"

namespace dubsar {
namespace {

using test::grooved_plate;
using test::Outcome;
using test::run_command;

using SurfaceTools = test::OnAMesh;

TEST_F(SurfaceTools, AClickWhileThePictureIsRoughIsNotLost) {
  const Outcome outcome = look_at("fine.obj", grooved_plate(450, 400),  // 360 thousand faces
                                  "wait shown\nclick tool-section\nkey 2\nkey 1\nclick surface 0.3 0.5\n"
                                  "click surface 0.7 0.5\nwait section 20\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(SurfaceTools, ACutBetweenTwoClicksIsMeasuredAndKept) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());  // where pictures and profiles of a mesh go
  const Outcome outcome =
      look_at("plate.obj", grooved_plate(),
              "wait whole\nclick tool-section\nclick surface 0.3 0.5\nclick surface 0.7 0.5\nwait section\n"
              "wait idle\nclick keep-section\nwait section-kept\nquit\n");
  std::filesystem::current_path(before);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::ifstream csv(folder_.path() / "plate_section_01.csv");
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  double lowest = 0;
  double longest = 0;
  while (std::getline(csv, line)) {
    std::istringstream fields(line);
    std::string piece, along, height;
    std::getline(fields, piece, ',');
    std::getline(fields, along, ',');
    std::getline(fields, height, ',');
    lowest = std::min(lowest, std::stod(height));
    longest = std::max(longest, std::stod(along));
  }
  EXPECT_NEAR(lowest, -1, 0.02);
  EXPECT_GT(longest, 2.2);
  EXPECT_LT(longest, 10);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "plate_section_01.svg"));
  // The command line cuts the same.
  const auto svg = (folder_.path() / "cut.svg").string();
  const auto cut = run_command({"mesh", "section", (folder_.path() / "plate.obj").string(), "--from",
                                "-3,0.1,0", "--to", "3,0.1,0", "-o", svg, "--json"})
                       .json();
  EXPECT_NEAR(cut["length_mm"].get<double>(), 6, 1e-6);
  EXPECT_NEAR(cut["lowest_mm"].get<double>(), -1, 1e-5);
  EXPECT_NEAR(cut["lowest_along_mm"].get<double>(), 3, 1e-5);
  EXPECT_EQ(run_command({"mesh", "section", (folder_.path() / "plate.obj").string(), "--from", "1,2", "--to",
                         "3,0,0", "-o", svg})
                .status,
            2);
}

TEST_F(SurfaceTools, ADoubleClickClosesAPolygonOfThreeCornersOrMore) {
  const Outcome outcome = look_at("plate.obj", grooved_plate(),
                                  "wait whole\nwait idle\nclick tool-select\n"
                                  "doubleclick surface 0.3 0.5\nexpect corners.1\n"  // encloses nothing
                                  "click surface 0.7 0.5\nexpect corners.2\n"
                                  "doubleclick surface 0.5 0.3\nwait selected 20\nexpect corners.0\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(SurfaceTools, CornersOverOneViewAreNotOfAnother) {
  const Outcome outcome = look_at("plate.obj", grooved_plate(),
                                  "wait whole\nwait idle\nclick tool-select\n"
                                  "click surface 0.3 0.5\nclick surface 0.7 0.5\nexpect corners.2\n"
                                  "drag surface 0.5 0.5 0.6 0.6 right\nexpect corners.2\n"  // the lamp
                                  "wheel surface 1\nexpect corners.0\n"
                                  "click surface 0.3 0.5\nclick surface 0.7 0.5\nexpect corners.2\n"
                                  "key 2\nexpect corners.0\n"
                                  "click surface 0.3 0.5\nclick surface 0.7 0.5\nexpect corners.2\n"
                                  "click view.obverse\nexpect corners.0\n"
                                  "click surface 0.3 0.5\nclick surface 0.7 0.5\nexpect corners.2\n"
                                  "drag surface 0.5 0.5 0.6 0.6\nexpect corners.0\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

/// Bounds of what is not black in the upper part of a picture, columns and rows.
std::pair<int, int> extent_px(const Image& picture, int rows) {
  int left = picture.width, right = -1, top = rows, bottom = -1;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (const Rgb8 c = picture.rgb(x, y); c[0] + c[1] + c[2] > 30) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    }
  }
  return {right - left + 1, bottom - top + 1};
}

TEST_F(SurfaceTools, APictureIsToScaleAlsoAboveWhatACardDrawsAtOnce) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const Outcome outcome =
      look_at("plate.obj", grooved_plate(),
              "wait whole\nwait idle\nclick keep-picture\nwait picture-kept\nclick dpi\nkey selectall\n"
              "type 2400\nkey enter\nclick keep-picture\npause 0.1\nwait picture-kept\nquit\n");
  std::filesystem::current_path(before);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const int dpi : {600, 2400}) {
    const Image picture = test::read_png(folder_.path() / ("plate_" + std::to_string(dpi) + "dpi_01.png"));
    ASSERT_GT(picture.width, 0) << dpi;
    const double px_per_mm = dpi / 25.4;
    const auto [wide, high] = extent_px(picture, picture.height - static_cast<int>(3.2 * px_per_mm));
    EXPECT_NEAR(std::max(wide, high) / px_per_mm, 10, 2 / px_per_mm) << dpi;
    EXPECT_NEAR(std::min(wide, high) / px_per_mm, 6, 2 / px_per_mm) << dpi;
  }
}

/// It says what its colours mean where it is looked at without the window.
TEST_F(SurfaceTools, APictureOfAnOverlayHasItsLegendAboveTheSurface) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const Outcome outcome =
      look_at("plate.obj", grooved_plate(),
              "wait whole\nwait idle\nclick keep-picture\nwait picture-kept\nclick overlay\n"
              "click overlay.Openness\nwait legend\nwait whole\nclick keep-picture\n"
              "pause 0.1\nwait picture-kept\nquit\n");
  std::filesystem::current_path(before);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto drawn = [&](const char* name) {
    const Image picture = test::read_png(folder_.path() / name);
    int count = 0;
    for (int y = 0; y < static_cast<int>(3 * 600 / 25.4); ++y) {
      for (int x = 0; x < picture.width; ++x) {
        count += picture.rgb(x, y) == Rgb8{0, 0, 0} ? 0 : 1;
      }
    }
    return count;
  };
  EXPECT_EQ(drawn("plate_600dpi_01.png"), 0) << "clay needs none";
  EXPECT_GT(drawn("plate_600dpi_02.png"), 500);
}

/// A plate of 100 x 60 mm in waves.
std::string wavy_plate() {
  constexpr int kRows = 60;
  constexpr int kCols = 100;
  std::string out;
  for (int r = 0; r <= kRows; ++r) {
    for (int c = 0; c <= kCols; ++c) {
      out += "v " + std::to_string(c) + " " + std::to_string(r) + " " +
             std::to_string(2 * std::sin(0.5 * c) * std::sin(0.5 * r)) + "\n";
    }
  }
  const auto at = [](int row, int col) { return std::to_string(1 + row * (kCols + 1) + col); };
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kCols; ++c) {
      out += "f " + at(r, c) + " " + at(r, c + 1) + " " + at(r + 1, c + 1) + "\nf " + at(r, c) + " " +
             at(r + 1, c + 1) + " " + at(r + 1, c) + "\n";
    }
  }
  return out;
}

/// Forty tiles; other colours are chosen while the first of them are drawn.
TEST_F(SurfaceTools, APictureIsOfOneFieldWhateverIsChosenMeanwhile) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const Outcome outcome =
      look_at("plate.obj", wavy_plate(),
              "resize 1024 760\nwait whole\nwait idle\nclick overlay\n"
              "click overlay.Mean curvature, 1/mm\nwait legend\nwait idle\nclick overlay\n"
              "click overlay.Openness\nwait legend\nclick dpi\nkey selectall\ntype 900\nkey enter\n"
              "wait whole\nclick keep-picture\nclick overlay\nclick overlay.Mean curvature, 1/mm\n"
              "wait picture-kept\nwait legend\nclick overlay\nclick overlay.Openness\nwait legend\n"
              "wait whole\nclick keep-picture\npause 0.1\nwait picture-kept\nquit\n");
  std::filesystem::current_path(before);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image disturbed = test::read_png(folder_.path() / "plate_900dpi_01.png");
  const Image alone = test::read_png(folder_.path() / "plate_900dpi_02.png");
  ASSERT_GT(std::min(alone.width, alone.height), 2000);
  EXPECT_EQ(disturbed.width, alone.width);
  EXPECT_TRUE(disturbed.bytes == alone.bytes) << "its last tiles show something else";
}

}  // namespace
}  // namespace dubsar
