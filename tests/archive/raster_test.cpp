// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/random.h"
#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

Framing frame(int px, double mm) {
  return {px, px, -mm / 2, mm / 2, 0.0, mm / px};
}

// A triangulated sheet has no crack and no pixel that two faces claim: every centre inside is covered.
TEST(Rasterise, LeavesNoCrackBetweenNeighbours) {
  Random random(7);
  Mesh mesh = height_sheet(40, 10.0F, [](float, float) { return 0.0F; });
  for (Eigen::Vector3f& p : mesh.positions) {
    const bool is_rim = std::abs(p.x()) > 4.9F || std::abs(p.y()) > 4.9F;
    if (!is_rim) {
      p += Eigen::Vector3f{static_cast<float>(random.uniform(-0.05, 0.05)),
                           static_cast<float>(random.uniform(-0.05, 0.05)), 0};
    }
  }
  const RenderScene scene(mesh);
  const VisibilityBuffer buffer = rasterise(scene, face_camera(Face::kObverse), frame(333, 9.9), 1);
  EXPECT_EQ(std::count(buffer.id.begin(), buffer.id.end(), kNothing), 0);
  const std::set<std::uint32_t> seen(buffer.id.begin(), buffer.id.end());
  EXPECT_EQ(seen.size(), mesh.faces.size()) << "every face of this sheet is larger than a pixel";
}

TEST(Rasterise, ShowsTheNearerFaceAndTheLowerIndexOfEqualOnes) {
  Mesh mesh;
  for (const float z : {0.0F, 2.0F, 2.0F, 1.0F}) {
    add_quad(mesh, {{{-5, -5, z}, {5, -5, z}, {5, 5, z}, {-5, 5, z}}}, {0, 0, 0});
  }
  const RenderScene scene(mesh);
  const VisibilityBuffer buffer = rasterise(scene, face_camera(Face::kObverse), frame(64, 8.0), 2);
  for (const std::uint32_t id : buffer.id) {
    EXPECT_TRUE(id == 2 || id == 3) << id;
  }
  EXPECT_FLOAT_EQ(buffer.z_mm[100], 2.0F);
}

TEST(Rasterise, PointsShowWhereThereIsNoMeshAndJustBelowIt) {
  Mesh mesh;
  add_quad(mesh, {{{-5, -5, 0}, {0, -5, 0}, {0, 5, 0}, {-5, 5, 0}}}, {0, 0, 0});
  ColouredPoints points;
  points.positions_mm = {{3, 0, -4}, {-2, 2, -0.2F}, {-2, -2, -3}, {3, 3, 0}};
  points.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1}};
  points.radius_mm = 0.5F;
  points.bury_mm = 0.4F;
  const RenderScene scene(mesh, &points);
  const VisibilityBuffer buffer = rasterise(scene, face_camera(Face::kObverse), frame(100, 10.0), 1);
  const auto id_at = [&](double x, double y) {
    const auto col = static_cast<std::size_t>((x + 5) * 10);
    const auto row = static_cast<std::size_t>((5 - y) * 10);
    return buffer.id[row * 100 + col];
  };
  EXPECT_EQ(id_at(3, 0), kPointBit | 0U) << "there is no mesh";
  EXPECT_EQ(id_at(-2, 2), kPointBit | 1U) << "just below the mesh";
  EXPECT_LT(id_at(-2, -2), 2U) << "deep below the mesh";
  EXPECT_EQ(id_at(3, 3), kNothing) << "seen from behind";
}

TEST(RenderScene, LeavesOutFacesThatCannotBeDrawn) {
  Mesh mesh = coloured_box(4, 4, 4);
  const std::size_t sound = mesh.faces.size();
  mesh.faces.push_back({0, 1, 99999});
  mesh.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  mesh.colours.push_back({0, 0, 0});
  mesh.faces.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  mesh.positions.emplace_back(1e30F, 0.0F, 0.0F);  // belongs to no face
  mesh.colours.push_back({0, 0, 0});
  const RenderScene scene(mesh);
  EXPECT_EQ(scene.faces().size(), sound);
  EXPECT_NEAR(scene.extent(face_camera(Face::kObverse)).size_mm().x(), 4.0, 1e-6);
  const VisibilityBuffer buffer = rasterise(scene, face_camera(Face::kObverse), frame(32, 4.0), 1);
  EXPECT_NE(buffer.id[16 * 32 + 8], kNothing);
}

}  // namespace
}  // namespace dubsar
