// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/shown_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/support/raster_mesh.h"

namespace dubsar::ui {
namespace {

/// A wavy sheet of 2 n² faces.
Mesh sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      mesh.positions.emplace_back(0.1F * static_cast<float>(x), 0.1F * static_cast<float>(y),
                                  std::sin(0.02F * static_cast<float>(x)));
    }
  }
  test::add_raster_faces(mesh, 0, n);
  return mesh;
}

TEST(ShownMesh, KeepsEveryFaceOnceInBlocksThatHoldThem) {
  const Mesh mesh = sheet(250);  // more than 2^16 faces
  const ShownMesh shown = shown_mesh(mesh);
  ASSERT_EQ(shown.faces.size(), mesh.faces.size());
  std::set<std::uint32_t> seen(shown.face_of.begin(), shown.face_of.end());
  EXPECT_EQ(seen.size(), mesh.faces.size());
  std::size_t in_blocks = 0;
  for (const FaceBlock& block : shown.blocks) {
    EXPECT_EQ(block.first, in_blocks);
    in_blocks += block.count;
    for (std::uint32_t f = block.first; f < block.first + block.count; ++f) {
      EXPECT_EQ(shown.faces[f], mesh.faces[shown.face_of[f]]);
      for (const std::uint32_t v : shown.faces[f]) {
        ASSERT_TRUE(block.box_mm.contains(mesh.positions[v]));
      }
    }
  }
  EXPECT_EQ(in_blocks, mesh.faces.size());
  EXPECT_EQ(shown.normals.size(), mesh.positions.size()) << "made where the mesh has none";
}

TEST(ShownMesh, TheCoarseSurfaceHasFewFacesNearTheFine) {
  const Mesh mesh = sheet(700);  // 980 thousand faces
  const ShownMesh shown = shown_mesh(mesh);
  EXPECT_GT(shown.coarse.size(), kFacesInMotion / 4);
  EXPECT_LT(shown.coarse.size(), 2 * kFacesInMotion);
  double area = 0;
  for (const auto& [a, b, c] : shown.coarse) {
    const auto& p = shown.positions;
    area += 0.5 * static_cast<double>((p[b] - p[a]).cross(p[c] - p[a]).norm());
  }
  EXPECT_NEAR(area, surface_area_mm2(mesh), 0.03 * surface_area_mm2(mesh));
}

TEST(ShownMesh, BrokenFacesAreLeftOutAndCounted) {
  Mesh mesh = sheet(4);
  const std::size_t sound = mesh.faces.size();
  mesh.faces.push_back({0, 1, 4000000});
  mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.faces.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  const ShownMesh shown = shown_mesh(mesh);
  EXPECT_EQ(shown.faces.size(), sound);
  EXPECT_EQ(shown.left_out, 2U);
  EXPECT_TRUE(std::ranges::all_of(shown.positions, [](const auto& p) { return p.allFinite(); }));
  EXPECT_TRUE(shown.box_mm.sizes().allFinite());
}

TEST(ShownMesh, PointsAndNothingAtAllAreNoTrouble) {
  Mesh points;
  points.positions = {{0, 0, 0}, {1, 2, 3}};
  const ShownMesh shown = shown_mesh(points);
  EXPECT_TRUE(shown.faces.empty());
  EXPECT_EQ(shown.normals.size(), 2U);
  EXPECT_TRUE(shown.blocks.empty());
  EXPECT_FALSE(shown_mesh(Mesh{}).box_mm.isEmpty());
}

}  // namespace
}  // namespace dubsar::ui
