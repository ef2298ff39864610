// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/shown_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/support/raster_mesh.h"
#include "ui/view/face_runs.h"
#include "ui/view/orbit_camera.h"

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

TEST(ShownMesh, AFarVertexThatNoFaceHasIsNotLookedAt) {
  Mesh mesh = sheet(4);
  const Eigen::AlignedBox3f box = shown_mesh(mesh).box_mm;
  mesh.positions.emplace_back(9000, 0, 0);
  EXPECT_TRUE(shown_mesh(mesh).box_mm.isApprox(box));
  EXPECT_EQ(shown_mesh(mesh).positions.size(), mesh.positions.size());
}

TEST(ShownMesh, TellsWhatTheMeshSaysOfItsVertices) {
  Mesh mesh = sheet(4);
  const ShownMesh bare = shown_mesh(mesh);
  EXPECT_FALSE(bare.has_reliability || bare.has_scans || bare.has_flags);
  mesh.reliability.assign(mesh.positions.size(), 0.5F);
  mesh.scans.assign(mesh.positions.size(), 2);
  const ShownMesh told = shown_mesh(mesh);
  EXPECT_TRUE(told.has_reliability && told.has_scans);
  EXPECT_FALSE(told.has_flags);
}

TEST(ShownMesh, LevelsOfDetailAreInBlocksThatHoldThem) {
  const Mesh mesh = sheet(900);  // 1.6 million faces
  const ShownMesh shown = shown_mesh(mesh);
  ASSERT_EQ(shown.coarser.size(), 2U);
  for (const ShownLevel& level : shown.coarser) {
    std::size_t in_blocks = 0;
    for (const FaceBlock& block : level.blocks) {
      EXPECT_EQ(block.first, in_blocks);
      in_blocks += block.count;
      for (std::uint32_t f = block.first; f < block.first + block.count; ++f) {
        for (const std::uint32_t v : level.detail.faces[f]) {
          ASSERT_TRUE(block.box_mm.contains(shown.positions[v]));
        }
      }
    }
    EXPECT_EQ(in_blocks, level.detail.faces.size());
    EXPECT_LT(level.detail.from.back(), shown.faces.size());
  }
}

TEST(ShownMesh, ItsFewestFacesAreAMeshOfTheirOwn) {
  const ShownMesh whole = shown_mesh(sheet(900));
  const ShownMesh few = fewest_faces(whole);
  const ShownLevel& level = whole.coarser.front();
  ASSERT_EQ(few.faces.size(), level.detail.faces.size());
  EXPECT_LT(few.positions.size(), whole.positions.size() / 4);
  EXPECT_EQ(few.normals.size(), few.positions.size());
  EXPECT_EQ(few.traits.size(), few.positions.size());
  EXPECT_TRUE(few.coarser.empty());
  for (std::size_t f = 0; f < few.faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(few.positions[few.faces[f][k]], whole.positions[level.detail.faces[f][k]]);
    }
  }
  const ShownMesh small = shown_mesh(sheet(20));  // which has no coarser one
  EXPECT_EQ(fewest_faces(small).faces, small.faces);
}

/// Turning must not cost more for being nearer, and not show less than it could.
TEST(ShownMesh, SoManyFacesAreInThePictureHoweverNear) {
  const ShownMesh shown = shown_mesh(sheet(900));
  std::vector<std::vector<FaceBlock>> levels;
  for (const ShownLevel& level : shown.coarser) {
    levels.push_back(level.blocks);
  }
  levels.push_back(shown.blocks);
  OrbitCamera camera;
  camera.eye_from_model = Eigen::AngleAxisf(0.4F, Eigen::Vector3f::UnitX());
  camera.fit(shown.box_mm, 1.6F);
  const std::size_t most = 3 * kFacesInMotion / 2;
  std::size_t last_level = 0;
  for (int k = 0; k < 6; ++k, camera.half_height_mm /= 2) {
    const Eigen::Matrix4f clip_from_model = camera.clip_from_model(1.6F);
    const std::size_t level = level_within(levels, clip_from_model, most);
    const std::size_t seen = faces_in(seen_runs(levels[level], clip_from_model));
    EXPECT_LE(seen, most) << "zoom " << k;
    if (level + 1 < levels.size()) {
      EXPECT_GT(faces_in(seen_runs(levels[level + 1], clip_from_model)), most)
          << "a finer one would have done";
    }
    EXPECT_GE(level, last_level) << "zoom " << k;
    last_level = level;
  }
  EXPECT_EQ(last_level, 2U) << "near enough, every face is there";
}

TEST(ShownMesh, RunsLeaveOutOnlyWhatIsOutside) {
  const ShownMesh shown = shown_mesh(sheet(250));
  OrbitCamera camera;
  camera.eye_from_model = Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1, 2, 0.5F).normalized());
  camera.fit(shown.box_mm, 1.0F);
  camera.half_height_mm /= 3;
  const Eigen::Matrix4f clip_from_model = camera.clip_from_model(1.0F);
  std::vector<bool> in_runs(shown.faces.size(), false);
  std::size_t end = 0;
  for (const FaceRun& run : seen_runs(shown.blocks, clip_from_model)) {
    EXPECT_TRUE(end == 0 || run.first > end) << "runs that touch are one";
    end = run.first + run.count;
    std::fill_n(in_runs.begin() + static_cast<std::ptrdiff_t>(run.first), run.count, true);
  }
  std::size_t left_out = 0;
  for (std::size_t f = 0; f < shown.faces.size(); ++f) {
    if (!in_runs[f]) {
      ++left_out;
      Eigen::AlignedBox2f clip;
      for (const std::uint32_t v : shown.faces[f]) {
        clip.extend((clip_from_model * shown.positions[v].homogeneous()).head<2>());
      }
      EXPECT_FALSE(clip.intersects(Eigen::AlignedBox2f(Eigen::Vector2f(-1, -1), Eigen::Vector2f(1, 1))) &&
                   clip.min().cwiseAbs().maxCoeff() < 1);
    }
  }
  EXPECT_GT(left_out, shown.faces.size() / 5);
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
