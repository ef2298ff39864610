// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh_query.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <thread>

namespace dubsar {
namespace {

/// The square [0,1]² in z = 0, seen from +z.
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(MeshQuery, FirstHitAndMiss) {
  const MeshQuery query(square());
  const auto hit = query.first_hit({0.7F, 0.2F, 5}, {0, 0, -1}, 0, 100);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_mm, 5, 1e-5);
  EXPECT_EQ(hit->face, 0U);
  EXPECT_GT(hit->normal.z(), 0.99F);
  EXPECT_FALSE(query.first_hit({2, 2, 5}, {0, 0, -1}, 0, 100));
  EXPECT_FALSE(query.first_hit({0.5F, 0.5F, 5}, {0, 0, -1}, 0, 4));
}

TEST(MeshQuery, OccludedExcludesTheEnds) {
  const MeshQuery query(square());
  EXPECT_TRUE(query.occluded({0.5F, 0.4F, 1}, {0.5F, 0.4F, -1}, 0.01F));
  EXPECT_FALSE(query.occluded({0.5F, 0.4F, 0}, {0.5F, 0.4F, 1}, 0.01F));
}

TEST(MeshQuery, ClosestOnFaceEdgeAndBeyondReach) {
  const MeshQuery query(square());
  const auto above = query.closest({0.25F, 0.5F, 0.3F}, 1);
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->distance_mm, 0.3, 1e-6);
  const auto beside = query.closest({1.4F, 0.5F, 0.3F}, 1);
  ASSERT_TRUE(beside);
  EXPECT_NEAR(beside->distance_mm, 0.5, 1e-6);
  EXPECT_NEAR(beside->point_mm.x(), 1.0, 1e-6);
  EXPECT_FALSE(query.closest({0.5F, 0.5F, 3}, 1));
}

TEST(MeshQuery, EmptyMeshAnswersNothing) {
  const MeshQuery query{Mesh{}};
  EXPECT_FALSE(query.first_hit({0, 0, 5}, {0, 0, -1}, 0, 100));
  EXPECT_FALSE(query.closest({0, 0, 0}, 100));
}

/// Every tablet is scanned by threads of its own: what a tree needs may not stay when they end.
TEST(MeshQuery, NothingStaysOfTheThreadsThatBuiltTrees) {
  const auto build = [] { std::thread([] { const MeshQuery query(square()); }).join(); };
  for (int k = 0; k < 20; ++k) {  // pools of threads, caches of the allocator
    build();
  }
  if (::mallinfo2().uordblks == 0) {
    GTEST_SKIP() << "this build's allocator does not tell what is in use";
  }
  constexpr std::size_t kThreads = 200;
  const std::size_t before = ::mallinfo2().uordblks;
  for (std::size_t k = 0; k < kThreads; ++k) {
    build();
  }
  EXPECT_LT(::mallinfo2().uordblks, before + 50 * kThreads);
}

}  // namespace
}  // namespace dubsar
