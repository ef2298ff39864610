// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which edge is edge 0.

#include "analysis/wedge_numbering.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "analysis/wedges.h"
#include "core/random.h"
#include "tests/analysis/support/pits.h"

namespace dubsar {
namespace {

using Three = std::array<double, 3>;

TEST(WedgeNumbering, TurnsAllThatGoesByEdgesTogether) {
  WedgeCandidate candidate;
  Wedge& w = candidate.wedge;
  const auto points = [] {
    return std::array{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(2, 2, 2)};
  };
  w.directional_edge = 2;
  w.exit_points_mm = w.exit_points_surface_mm = w.exit_points_extent_mm = w.outer_vertices_mm =
      w.face_normals = points();
  w.face_angles_rad = w.opening_angles_rad = w.edge_lengths_mm = w.edge_slopes_rad = w.face_slopes_rad =
      w.edge_bows_mm = {0, 1, 2};
  w.sigma.edge_rad = w.sigma.edge_slope_rad = w.sigma.opening_rad = w.sigma.face_angle_rad =
      w.sigma.face_slope_rad = w.sigma.length_mm = w.faces_intact = candidate.coverage = {0, 1, 2};
  w.beyond_mesh = {false, false, true};
  candidate.faces = {0, 1, 2};
  number_from_directional_edge(&candidate);
  EXPECT_EQ(w.directional_edge, 0);
  for (const auto* places : {&w.exit_points_mm, &w.exit_points_surface_mm, &w.exit_points_extent_mm,
                             &w.outer_vertices_mm, &w.face_normals}) {
    EXPECT_EQ((*places)[0].x(), 2);
    EXPECT_EQ((*places)[1].x(), 0);
    EXPECT_EQ((*places)[2].x(), 1);
  }
  const Three turned = {2, 0, 1};
  for (const Three* values :
       {&w.face_angles_rad, &w.opening_angles_rad, &w.edge_lengths_mm, &w.edge_slopes_rad, &w.face_slopes_rad,
        &w.edge_bows_mm, &w.sigma.edge_rad, &w.sigma.edge_slope_rad, &w.sigma.opening_rad,
        &w.sigma.face_angle_rad, &w.sigma.face_slope_rad, &w.sigma.length_mm, &w.faces_intact,
        &candidate.coverage}) {
    EXPECT_EQ(*values, turned);
  }
  EXPECT_EQ(w.beyond_mesh, (std::array{true, false, false}));
  EXPECT_EQ(candidate.faces, (std::vector<std::int8_t>{1, 2, 0})) << "what was face 2 is face 0";
  const WedgeCandidate once = candidate;
  number_from_directional_edge(&candidate);
  EXPECT_EQ(candidate.wedge.edge_lengths_mm, once.wedge.edge_lengths_mm);
  EXPECT_EQ(candidate.faces, once.faces);
}

TEST(WedgeNumbering, IsTheSameHoweverTheMeshLies) {
  const pits::Pit pit;
  const Mesh flat = pits::sheet(20, 0.1, [&](double x, double y) { return pit.floor(x, y); });
  Random random(7);
  for (int pose = 0; pose < 6; ++pose) {
    Eigen::Vector4d q;
    for (double& part : q) {
      part = random.normal();
    }
    const Eigen::Matrix3d turn = Eigen::Quaterniond(q).normalized().toRotationMatrix();
    Mesh mesh = flat;
    for (Eigen::Vector3f& p : mesh.positions) {
      p = (turn * p.cast<double>()).cast<float>();
    }
    mesh.normals.clear();
    const JobContext job;
    const VertexGraph graph = make_vertex_graph(mesh);
    const auto fields = compute_surface_fields(mesh, graph, {}, job);
    ASSERT_TRUE(fields);
    const auto set = find_wedges(mesh, graph, *fields, {}, job);
    ASSERT_TRUE(set);
    ASSERT_EQ(set->wedges.size(), 1U) << pose;
    const Wedge& wedge = set->wedges.front();
    EXPECT_EQ(wedge.directional_edge, 0) << pose;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((turn.transpose() * wedge.exit_points_mm[k] - pit.exits[k]).norm(), 0.25) << pose << " " << k;
      EXPECT_GT(wedge.face_normals[k].dot(turn * pit.normal(k)), 0.99) << pose << " " << k;
    }
    // The vertices' faces go by the same numbers.
    for (std::size_t v = 0; v < set->face_of.size(); ++v) {
      if (set->face_of[v] < 0) {
        continue;
      }
      const Eigen::Vector3d at = flat.positions[v].cast<double>() - pit.tip;
      EXPECT_NEAR(pit.normal(static_cast<std::size_t>(set->face_of[v])).dot(at), 0, 0.1) << pose << " " << v;
    }
  }
}

}  // namespace
}  // namespace dubsar
