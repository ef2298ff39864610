// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/vertex_graph.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "sim/tablet.h"

namespace dubsar {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Mesh two_triangles() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {5, 5, 5}};
  mesh.faces = {{0, 1, 2}, {2, 1, 3}};
  return mesh;
}

TEST(VertexGraph, RingsAreAscendingAndALoneVertexHasNone) {
  const VertexGraph graph = make_vertex_graph(two_triangles());
  ASSERT_EQ(graph.vertex_count(), 5U);
  EXPECT_THAT(graph.ring(0), ElementsAre(1, 2));
  EXPECT_THAT(graph.ring(1), ElementsAre(0, 2, 3));
  EXPECT_THAT(graph.ring(3), ElementsAre(1, 2));
  EXPECT_THAT(graph.ring(4), IsEmpty());
  EXPECT_THAT(graph.faces_at(1), ElementsAre(0, 1));
}

TEST(VertexGraph, FaultyFacesTakeNoPart) {
  Mesh mesh = two_triangles();
  mesh.faces.push_back({3, 3, 4});  // a vertex twice
  mesh.faces.push_back({0, 1, 9});  // no such vertex
  mesh.faces.push_back({1, 0, 2});  // the first again, flipped
  const VertexGraph graph = make_vertex_graph(mesh);
  EXPECT_THAT(graph.ring(4), IsEmpty());
  EXPECT_THAT(graph.ring(0), ElementsAre(1, 2));
  EXPECT_THAT(graph.faces_at(0), ElementsAre(0));
  EXPECT_THAT(graph.faces_at(1), ElementsAre(0, 1));
}

TEST(VertexGraph, AnEdgeOfThreeFacesIsNoTrouble) {
  Mesh mesh = two_triangles();
  mesh.faces.push_back({1, 2, 4});
  const VertexGraph graph = make_vertex_graph(mesh);
  EXPECT_THAT(graph.ring(1), ElementsAre(0, 2, 3, 4));
  EXPECT_THAT(graph.faces_at(2), ElementsAre(0, 1, 2));
}

TEST(VertexGraph, IsTheSameForAnyNumberOfThreads) {
  sim::TabletOptions options;
  options.size_mm = {20, 15, 8};
  options.spacing_mm = 0.3;
  JobContext making;
  const auto tablet = sim::make_tablet(options, making);
  ASSERT_TRUE(tablet);
  const VertexGraph many = make_vertex_graph(tablet->mesh);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const VertexGraph single = make_vertex_graph(tablet->mesh);
  EXPECT_EQ(many.start, single.start);
  EXPECT_EQ(many.neighbour, single.neighbour);
  EXPECT_EQ(many.face, single.face);
  // Closed: as many edges as Euler says, each in two rings.
  EXPECT_EQ(many.neighbour.size(), 2 * (tablet->mesh.faces.size() * 3 / 2));
}

}  // namespace
}  // namespace dubsar
