// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Two tablets side by side in the window.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_mesh.h"
#include "tests/ui/support/read_png.h"

namespace dubsar {
namespace {

using test::grooved_plate;
using test::Outcome;
using test::run_command;

using SideBySide = test::OnAMesh;

TEST_F(SideBySide, TwoSideBySideTurnTogetherOrAlone) {
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

TEST_F(SideBySide, OfTwoSideBySideTheSideThatWasAskedForStaysWhenTheWindowIsResized) {
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

TEST_F(SideBySide, OfTwoSideBySideEachIsDoubtedAsItIsAlone) {
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
TEST_F(SideBySide, WhereTheWindowIsNarrowTheBarOfTwoTakesMoreRows) {
  std::ofstream(in("left.obj")) << grooved_plate();
  std::ofstream(in("narrow.script")) << "wait whole\nexpect whole.view.bottom\nexpect whole.together\n"
                                        "expect whole.lamp\nclick lamp\nquit\n";
  const Outcome outcome =
      run_command({"view", in("left.obj"), in("left.obj"), "--script", in("narrow.script"), "--language",
                   "de", "--width", "700", "--height", "600"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace
}  // namespace dubsar
