// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the window says to displays, scripts and meshes that it cannot work with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"
#include "tests/ui/support/on_a_mesh.h"

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

using MeshInput = test::OnAMesh;

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
