// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "formats/mesh_io.h"
#include "tests/formats/closed_surface.h"
#include "tests/formats/format_support.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

using testing::is_closed_and_oriented;
using testing::line_of;

TEST(RealMeshes, TabletS264) {
  const auto path = test::real_data() / "tablet_S264" / "cuneiform.glb";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "no real meshes beside the project";
  }
  const auto mesh = read_mesh(path, {.mm_per_unit = 1.0});
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->positions.size(), 10002U);
  EXPECT_EQ(mesh->faces.size(), 20000U);
  EXPECT_TRUE(is_closed_and_oriented(*mesh));
  Eigen::Vector3f low = mesh->positions[0];
  Eigen::Vector3f high = low;
  for (const auto& p : mesh->positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // Computed from the file's numbers apart from this program; the scene turns the tablet by about half a
  // turn.
  EXPECT_NEAR(low.x(), -10.496240, 1e-5);
  EXPECT_NEAR(high.x(), 10.481205, 1e-5);
  EXPECT_NEAR(low.y(), -6.890081, 1e-5);
  EXPECT_NEAR(high.y(), 9.297952, 1e-5);
  EXPECT_NEAR(low.z(), -8.088435, 1e-5);
  EXPECT_NEAR(high.z(), 10.547880, 1e-5);
}

TEST(RealMeshes, BunnyZipperAndOgham) {
  const auto zipper = test::real_data() / "stanford_bunny" / "reconstruction" / "bun_zipper.ply";
  const auto stones = test::real_data() / "ogham";
  if (!std::filesystem::exists(zipper) || !std::filesystem::exists(stones)) {
    GTEST_SKIP() << "no real meshes beside the project";
  }
  const auto mesh = read_mesh(zipper, {.mm_per_unit = 1000.0});
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->positions.size(), 35947U);
  EXPECT_EQ(mesh->faces.size(), 69451U);
  for (const char* name : {"C-1.ply", "C-2.ply", "I-3.ply", "Tullaherin_II.obj"}) {
    const auto stone = read_mesh(stones / name);
    ASSERT_TRUE(stone) << line_of(stone);
    EXPECT_GT(stone->faces.size(), 1000U) << name;
  }
}

}  // namespace
}  // namespace dubsar
