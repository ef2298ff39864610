// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/manifold.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "triangulation/draft.h"
#include "triangulation/mesh_check.h"
#include "triangulation/parted_fans.h"

namespace dubsar {
namespace {

TEST(Manifold, SplitsAVertexWhereFansTouch) {
  std::vector<Triangle> faces = {{0, 1, 2}, {0, 3, 4}};
  const auto copies = make_manifold(faces, 5);
  ASSERT_EQ(copies, std::vector<std::uint32_t>{0});
  EXPECT_EQ(faces[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(faces[1], (Triangle{5, 3, 4}));
}

TEST(Manifold, LeavesASoundMeshAlone) {
  std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const std::vector<Triangle> before = faces;
  EXPECT_TRUE(make_manifold(faces, 4).empty());
  EXPECT_EQ(faces, before);
}

TEST(Manifold, MakesSomethingSoundOfAnyFaces) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    Mesh mesh;
    constexpr std::uint32_t kVertices = 12;
    for (std::uint32_t v = 0; v < kVertices; ++v) {
      const auto draw = [&] { return static_cast<float>(random.normal()); };
      mesh.positions.push_back({draw(), draw(), draw()});
    }
    for (int f = 0; f < 40; ++f) {
      mesh.faces.push_back({static_cast<std::uint32_t>(random.below(kVertices)),
                            static_cast<std::uint32_t>(random.below(kVertices)),
                            static_cast<std::uint32_t>(random.below(kVertices))});
    }
    for (const std::uint32_t v : make_manifold(mesh.faces, kVertices)) {
      mesh.positions.push_back(Eigen::Vector3f(mesh.positions[v]));
    }
    const MeshReport report = check_mesh(mesh);
    EXPECT_GT(report.faces, 0U);
    EXPECT_EQ(report.non_manifold_edges, 0U) << seed;
    EXPECT_EQ(report.non_manifold_vertices, 0U) << seed;
    EXPECT_EQ(report.inconsistent_faces, 0U) << seed;
  }
}

TEST(Manifold, BoundaryLoopsStayWithTheirFans) {
  const std::vector<Triangle> faces = {{0, 1, 2}, {0, 3, 4}};
  const HalfEdges edges(faces, 5);
  const auto loops = boundary_loops(faces, edges);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].vertices, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(loops[1].vertices, (std::vector<std::uint32_t>{0, 3, 4}));
  EXPECT_TRUE(loops[0].closed && loops[1].closed);
}

TEST(Manifold, VerticesWithoutAFaceGoWithWhatTheyCarry) {
  Mesh mesh;
  mesh.positions = {{9, 9, 9}, {9, 8, 9}, {8, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.reliability = {0.F, 0.F, 0.F, .3F, .4F, .5F, .6F};
  mesh.faces = {{3, 4, 5}, {4, 6, 5}};
  compact_vertices(mesh);
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.faces, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.reliability, (std::vector<float>{.3F, .4F, .5F, .6F}));
}

TEST(Manifold, OfACancelledJobNothingIsKnownAndNothingSplit) {
  JobContext job;
  job.cancel();
  std::vector<Triangle> faces = {{0, 1, 2}, {0, 3, 4}};
  const HalfEdges none(faces, 5, {}, job);
  EXPECT_EQ(none.vertex_count(), 5U);
  for (std::uint32_t v = 0; v < 5; ++v) {
    EXPECT_TRUE(none.from(v).empty());
  }
  const HalfEdges edges(faces, 5);
  EXPECT_EQ(face_components(faces, edges).sizes.size(), 2U);
  EXPECT_TRUE(face_components(faces, edges, job).sizes.empty());
  EXPECT_TRUE(make_manifold(faces, 5, {}, job).empty());
  EXPECT_EQ(faces[1], (Triangle{0, 3, 4}));

  Draft draft;
  draft.mesh.positions.assign(5, {0, 0, 0});
  draft.mesh.faces = faces;
  draft.near_rim.assign(5, 1);
  part_fans(draft, job);
  EXPECT_EQ(draft.mesh.positions.size(), 5U);
  EXPECT_EQ(draft.mesh.faces, faces);
}

}  // namespace
}  // namespace dubsar
