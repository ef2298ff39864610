// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the window says to displays, scripts and meshes that it cannot work with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"
#include "tests/ui/support/on_a_display.h"
#include "tests/ui/support/read_png.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(WindowInput, NoDisplayIsOneLineAndStatusThree) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const test::TemporaryFolder folder;
  const Outcome outcome = run_command({"station", "--session", (folder.path() / "s").string()});
  EXPECT_EQ(outcome.status, 3);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("command line"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
}

TEST(WindowInput, ADisplayWithoutOpenGlIsOneLineAndStatusThree) {
  const test::Display display("800x600x24", false);
  if (!display.works()) {
    FAIL() << "there is no Xvfb here: install xvfb (packages.txt)";
  }
  const Outcome outcome = run_command({"station"});
  EXPECT_EQ(outcome.status, 3);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("OpenGL 4.1"));
}

class MeshInput : public test::OnADisplay {
 protected:
  Outcome look_at(const std::string& name, const std::string& bytes, const std::string& script) {
    const auto mesh = folder_.path() / name;
    std::ofstream(mesh) << bytes;
    const auto file = folder_.path() / "look.script";
    std::ofstream(file) << script;
    return run_command({"station", "--mesh", mesh.string(), "--script", file.string(), "--width", "1024",
                        "--height", "640"});
  }
};

constexpr const char* kLook = "wait whole\ndrag surface 0.3 0.3 0.6 0.6\nwheel surface 3\nwait idle\nquit\n";

TEST_F(MeshInput, PointsWithoutFacesOrNormalsAreShown) {
  const Outcome outcome = look_at("points.obj", "v 0 0 0\nv 10 0 1\nv 0 10 0\nv 10 10 2\n", kLook);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(MeshInput, APlyOfPointsIsShown) {
  const Outcome outcome =
      look_at("points.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
              "property float z\nend_header\n0 0 0\n10 0 1\n0 10 0\n10 10 2\n",
              kLook);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(MeshInput, NumbersThatMeasureWronglyAreSaid) {
  const std::string faces = "f 1 2 3\nf 2 4 3\n";
  const std::string says = "wait whole\nwait mesh-doubt\nquit\n";
  const Outcome far =
      look_at("far.obj", "v 4000000 0 0\nv 4000010 0 0\nv 4000000 10 0\nv 4000010 10 1\n" + faces, says);
  EXPECT_EQ(far.status, 0) << far.err;
  const Outcome small =
      look_at("metres.obj", "v 0 0 0\nv 0.04 0 0\nv 0 0.03 0\nv 0.04 0.03 0.01\n" + faces, says);
  EXPECT_EQ(small.status, 0) << small.err;
  const Outcome sound = look_at("sound.obj", "v 500 0 0\nv 510 0 0\nv 500 10 0\nv 510 10 1\n" + faces,
                                "wait whole\nwait idle\npause 0.3\nexpect idle\nwait mesh-doubt 1\nquit\n");
  EXPECT_EQ(sound.status, 1) << "nothing is wrong with it";
}

TEST_F(MeshInput, AFaceOfNoAreaIsShownWithTheOthers) {
  const Outcome outcome = look_at(
      "slivers.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 10 10 1\nf 1 2 3\nf 2 4 3\nf 1 1 2\nf 1 2 2\n", kLook);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(MeshInput, WhatIsNoMeshIsOneLineAndStatusTwo) {
  for (const char* bytes : {"", "ply\nformat ascii 1.0\n", "not a mesh"}) {
    const Outcome outcome = look_at("broken.ply", bytes, kLook);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  }
}

/// A plate of 10 x 6 mm with a groove, 1 mm deep, across its middle.
std::string grooved_plate(int rows = 6, int cols = 40) {
  std::string out;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= cols; ++c) {
      const double x = -5 + 10.0 * c / cols;
      out += "v " + std::to_string(x) + " " + std::to_string(6.0 * r / rows - 3) + " " +
             std::to_string(-std::max(0.0, 1 - std::abs(x))) + "\n";
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const auto at = [&](int row, int col) { return std::to_string(1 + row * (cols + 1) + col); };
      out += "f " + at(r, c) + " " + at(r, c + 1) + " " + at(r + 1, c + 1) + "\nf " + at(r, c) + " " +
             at(r + 1, c + 1) + " " + at(r + 1, c) + "\n";
    }
  }
  return out;
}

TEST_F(MeshInput, AClickWhileThePictureIsRoughIsNotLost) {
  const Outcome outcome = look_at("fine.obj", grooved_plate(450, 400),  // 360 thousand faces
                                  "wait shown\nclick tool-section\nkey 2\nkey 1\nclick surface 0.3 0.5\n"
                                  "click surface 0.7 0.5\nwait section 20\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(MeshInput, ACutBetweenTwoClicksIsMeasuredAndKept) {
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

TEST_F(MeshInput, ADoubleClickClosesAPolygonOfThreeCornersOrMore) {
  const Outcome outcome = look_at("plate.obj", grooved_plate(),
                                  "wait whole\nwait idle\nclick tool-select\n"
                                  "doubleclick surface 0.3 0.5\nexpect corners.1\n"  // encloses nothing
                                  "click surface 0.7 0.5\nexpect corners.2\n"
                                  "doubleclick surface 0.5 0.3\nwait selected 20\nexpect corners.0\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(MeshInput, CornersOverOneViewAreNotOfAnother) {
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

TEST_F(MeshInput, APictureIsToScaleAlsoAboveWhatACardDrawsAtOnce) {
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
TEST_F(MeshInput, APictureOfAnOverlayHasItsLegendAboveTheSurface) {
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
TEST_F(MeshInput, APictureIsOfOneFieldWhateverIsChosenMeanwhile) {
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

TEST_F(MeshInput, TwoSideBySideTurnTogetherOrAlone) {
  std::ofstream(folder_.path() / "left.obj") << grooved_plate();
  std::ofstream(folder_.path() / "right.obj") << grooved_plate();
  std::ofstream(in("pair.script")) << "wait whole\nwait idle\nscreenshot " << in("both.png")
                                   << "\ndrag left-tablet 0.5 0.5 0.7 0.6\nwait whole\nscreenshot "
                                   << in("together.png") << "\nkey l\nwait turned-alone\nkey 1\n"
                                   << "drag right-tablet 0.5 0.5 0.3 0.4\nwait whole\nscreenshot "
                                   << in("alone.png") << "\nquit\n";
  const Outcome outcome = run_command({"view", in("left.obj"), in("right.obj"), "--script", in("pair.script"),
                                       "--width", "1300", "--height", "700"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  // Mean difference of two pictures, the names and the bars of scale aside; `dx` apart.
  const auto unlike = [&](const Image& a, const Image& b, int dx) {
    double sum = 0;
    int count = 0;
    for (int y = 150; y < 590; ++y) {
      for (int x = 60; x < a.width / 2 - 60; ++x, ++count) {
        sum += std::abs(int{a.rgb(x, y)[0]} - int{b.rgb(x + dx, y)[0]});
      }
    }
    return sum / count;
  };
  const Image both = test::read_png(in("both.png"));
  const Image together = test::read_png(in("together.png"));
  const Image alone = test::read_png(in("alone.png"));
  ASSERT_EQ(alone.width, 1300);
  // The panes begin where the window's margin ends, and lie half the rest apart.
  const auto apart = [&](const Image& picture) {
    double least = 1e9;
    for (int dx = picture.width / 2 - 12; dx <= picture.width / 2 + 12; ++dx) {
      least = std::min(least, unlike(picture, picture, dx));
    }
    return least;
  };
  EXPECT_LT(apart(both), 1);
  EXPECT_LT(apart(together), 1);
  EXPECT_GT(apart(alone), 3);
  EXPECT_GT(unlike(both, together, 0), 3);
  EXPECT_GT(unlike(both, together, both.width / 2), 3) << "both turned";
  // One that cannot be read is named, and nothing opens.
  const Outcome broken = run_command({"view", in("left.obj"), in("pair.script")});
  EXPECT_EQ(broken.status, 2);
}

TEST_F(MeshInput, OfTwoSideBySideTheSideThatWasAskedForStaysWhenTheWindowIsResized) {
  std::ofstream(in("left.obj")) << grooved_plate();
  std::ofstream(in("pair.script")) << "wait whole\nwait idle\nkey 3\nresize 1100 700\nwait whole\nscreenshot "
                                   << in("resized.png") << "\nkey 3\nwait whole\nscreenshot "
                                   << in("edge.png") << "\nkey 1\nwait whole\nscreenshot "
                                   << in("obverse.png") << "\nquit\n";
  const Outcome outcome = run_command({"view", in("left.obj"), in("left.obj"), "--script", in("pair.script"),
                                       "--width", "1300", "--height", "700"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image resized = test::read_png(in("resized.png"));
  ASSERT_EQ(resized.width, 1100);
  // Mean difference, names and bars of scale aside.
  const auto unlike = [&](const char* name) {
    const Image other = test::read_png(in(name));
    double sum = 0;
    int count = 0;
    for (int y = 150; y < 590; ++y) {
      for (int x = 60; x < resized.width - 60; ++x, ++count) {
        sum += std::abs(int{resized.rgb(x, y)[0]} - int{other.rgb(x, y)[0]});
      }
    }
    return sum / count;
  };
  EXPECT_LT(unlike("edge.png"), 0.5);
  EXPECT_GT(unlike("obverse.png"), 3);
}

TEST_F(MeshInput, OfTwoSideBySideEachIsDoubtedAsItIsAlone) {
  std::ofstream(in("left.obj")) << grooved_plate();
  std::istringstream plate(grooved_plate());
  std::ofstream in_metres(in("right.obj"));
  for (std::string kind; plate >> kind;) {
    double x = 0, y = 0, z = 0;
    plate >> x >> y >> z;
    const double scale = kind == "v" ? 0.001 : 1;
    in_metres << kind << ' ' << x * scale << ' ' << y * scale << ' ' << z * scale << '\n';
  }
  in_metres.close();
  std::ofstream(in("pair.script")) << "wait whole\nwait idle\nexpect doubt.right-tablet\nscreenshot "
                                   << in("both.png") << "\nquit\n";
  const Outcome outcome = run_command({"view", in("left.obj"), in("right.obj"), "--script", in("pair.script"),
                                       "--width", "1300", "--height", "700"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image both = test::read_png(in("both.png"));
  ASSERT_EQ(both.width, 1300);
  const auto reds = [&](int from, int to) {
    int count = 0;
    for (int y = 0; y < both.height; ++y) {
      for (int x = from; x < to; ++x) {
        const auto rgb = both.rgb(x, y);
        count += rgb[0] > rgb[1] + 80 && rgb[0] > rgb[2] + 80 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_GT(reds(both.width / 2, both.width), 200) << "its numbers are no millimetres";
  EXPECT_LT(reds(0, both.width / 2), 20);
}

/// As in large letters, in the language with the longer words.
TEST_F(MeshInput, WhereTheWindowIsNarrowTheBarOfTwoTakesMoreRows) {
  std::ofstream(in("left.obj")) << grooved_plate();
  std::ofstream(in("narrow.script")) << "wait whole\nexpect whole.view.bottom\nexpect whole.together\n"
                                        "expect whole.lamp\nclick lamp\nquit\n";
  const Outcome outcome =
      run_command({"view", in("left.obj"), in("left.obj"), "--script", in("narrow.script"), "--language",
                   "de", "--width", "700", "--height", "600"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(WindowInput, ABadScriptIsNamedByItsLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "bad.script";
  std::ofstream(file) << "wait idle\nshout\n";
  const Outcome outcome = run_command({"station", "--script", file.string()});
  EXPECT_EQ(outcome.status, 2);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("bad.script:2"));
}

}  // namespace
}  // namespace dubsar
