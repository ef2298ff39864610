// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a single hollow is measured to be.

#include "analysis/hollow_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/units.h"
#include "core/wedge_length.h"
#include "tests/analysis/support/pits.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

/// A wedge in clay that bends over a radius of 15 mm, and the vertices of its hollow in rising height.
struct Hollow {
  Mesh mesh;
  VertexGraph graph;
  SurfaceFields fields;
  std::vector<float> areas;
  std::vector<std::uint32_t> vertices;

  [[nodiscard]] Wedge measured(const std::vector<std::uint32_t>& in_order,
                               const WedgeOptions& options) const {
    const HollowMeasure measure(mesh, graph, fields, options, areas, false);
    std::vector<std::int32_t> slot(mesh.positions.size(), -1);
    const auto found = measure.measure(in_order, &slot);
    EXPECT_TRUE(found) << found.error();
    return found ? found->wedge : Wedge{};
  }
};

const Hollow& hollow() {
  static const std::unique_ptr<const Hollow> kHollow = [] {
    auto out = std::make_unique<Hollow>();
    const pits::Pit pit;
    out->mesh =
        pits::sheet(16, 0.08, [&](double x, double y) { return pit.floor(x, y) - (x * x + y * y) / 30.0; });
    out->graph = make_vertex_graph(out->mesh);
    out->fields = *compute_surface_fields(out->mesh, out->graph, {}, {});
    out->areas = vertex_areas(out->mesh, out->graph);
    for (std::uint32_t v = 0; v < out->mesh.positions.size(); ++v) {
      const Eigen::Vector3f& p = out->mesh.positions[v];
      if (pit.floor(p.x(), p.y()) < -0.03) {
        out->vertices.push_back(v);
      }
    }
    std::ranges::stable_sort(out->vertices, {}, [&](std::uint32_t v) { return out->fields.height_mm[v]; });
    return out;
  }();
  return *kHollow;
}

TEST(HollowMeasure, TheSurfacesNormalIsTheMeanOverAllOfItsClay) {
  const Hollow& h = hollow();
  ASSERT_GT(h.vertices.size(), 128U);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t v : h.vertices) {
    sum += h.areas[v] * h.fields.surface.normal(h.mesh.positions[v]).cast<double>();
  }
  const Wedge rising = h.measured(h.vertices, {});
  EXPECT_LT((rising.surface_normal - sum.normalized()).norm(), 1e-6);
  // What lies higher by a rounding comes later: that alone is to change nothing.
  std::vector<std::uint32_t> other = h.vertices;
  std::reverse(other.begin() + 1, other.end());
  EXPECT_LT((h.measured(other, {}).surface_normal - rising.surface_normal).norm(), 1e-6);
}

TEST(HollowMeasure, SlopesOfEdgesAreAsUnsureAsTheirDirectionsAndTheSurface) {
  const Wedge wedge = hollow().measured(hollow().vertices, {});
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(wedge.sigma.edge_slope_rad[k], std::hypot(wedge.sigma.edge_rad[k], 0.013), 1e-9);
  }
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

/// The usual pit, alone in flat clay.
const Hollow& flat_hollow() {
  static const std::unique_ptr<const Hollow> kHollow = [] {
    auto out = std::make_unique<Hollow>();
    const pits::Pit pit;
    out->mesh = pits::sheet(16, 0.08, [&](double x, double y) { return pit.floor(x, y); });
    out->graph = make_vertex_graph(out->mesh);
    out->fields = *compute_surface_fields(out->mesh, out->graph, {}, {});
    out->areas = vertex_areas(out->mesh, out->graph);
    for (std::uint32_t v = 0; v < out->mesh.positions.size(); ++v) {
      if (out->mesh.positions[v].z() < -0.03F) {
        out->vertices.push_back(v);
      }
    }
    std::ranges::stable_sort(out->vertices, {}, [&](std::uint32_t v) { return out->fields.height_mm[v]; });
    return out;
  }();
  return *kHollow;
}

/// What wedges.json says of each edge and face goes by one numbering: face k lies between edges k and k + 1,
/// opening k is that of the faces that meet in edge k. The pit opens by 99, 106 and 106 degrees, and its
/// faces have angles of 104, 95 and 104: what goes by another number is off by degrees.
TEST(HollowMeasure, AnglesLengthsAndVolumeAreThoseOfItsOwnPointsAndNormals) {
  for (const ExitDefinition exits : {ExitDefinition::kSurface, ExitDefinition::kExtent}) {
    WedgeOptions options;
    options.exits = exits;
    const Wedge wedge = flat_hollow().measured(flat_hollow().vertices, options);
    const auto& exit =
        exits == ExitDefinition::kSurface ? wedge.exit_points_surface_mm : wedge.exit_points_extent_mm;
    std::array<Eigen::Vector3d, 3> edge;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(wedge.exit_points_mm[k], exit[k]) << k;
      EXPECT_EQ(wedge.outer_vertices_mm[k], exit[k]) << k;
      edge[k] = exit[k] - wedge.depth_point_mm;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      SCOPED_TRACE(k);
      const std::size_t next = (k + 1) % 3;
      EXPECT_NEAR(wedge.edge_lengths_mm[k], edge[k].norm(), 1e-9);
      // Where an edge meets the surface is worked out in floats.
      EXPECT_NEAR(deg_from_rad(wedge.face_angles_rad[k]), angle_deg(edge[k], edge[next]), 0.05);
      EXPECT_NEAR(deg_from_rad(wedge.edge_slopes_rad[k]), 90 - angle_deg(edge[k], wedge.surface_normal),
                  0.05);
      EXPECT_NEAR(deg_from_rad(wedge.face_slopes_rad[k]),
                  angle_deg(wedge.face_normals[k], wedge.surface_normal), 1e-3);
      EXPECT_NEAR(deg_from_rad(wedge.opening_angles_rad[k]),
                  180 - angle_deg(wedge.face_normals[(k + 2) % 3], wedge.face_normals[k]), 1e-3);
      // Lines and planes are fits of their own, to within 1.5 and 1 degree of the pit's: sin 2.5° of it. The
      // third edge stands off the face by nearly all of its length.
      EXPECT_LT(std::abs(wedge.face_normals[k].dot(edge[k])), 0.08 * edge[k].norm());
      EXPECT_LT(std::abs(wedge.face_normals[k].dot(edge[next])), 0.08 * edge[next].norm());
    }
    EXPECT_NEAR(wedge.volume_mm3, std::abs(edge[0].dot(edge[1].cross(edge[2]))) / 6, 1e-9);
  }
}

/// Against the pit as it was made. Faces are found to a degree, edges to one and a half (WedgeModel), the
/// surface over so small a pit to some hundredths of a millimetre: that is four times as much along the tail,
/// which rises by 14 degrees.
TEST(HollowMeasure, AnglesDepthAndLengthsAreThoseOfThePit) {
  const pits::Pit pit;
  const Wedge wedge = flat_hollow().measured(flat_hollow().vertices, {});
  EXPECT_GT(wedge.surface_normal.z(), 0.995);
  EXPECT_NEAR(wedge.depth_mm, -pit.tip.z(), 0.1);
  for (std::size_t k = 0; k < 3; ++k) {
    SCOPED_TRACE(k);
    const Eigen::Vector3d edge = pit.exits[k] - pit.tip;
    EXPECT_NEAR(deg_from_rad(wedge.face_angles_rad[k]), angle_deg(edge, pit.exits[(k + 1) % 3] - pit.tip), 4);
    EXPECT_NEAR(deg_from_rad(wedge.opening_angles_rad[k]),
                180 - angle_deg(pit.normal((k + 2) % 3), pit.normal(k)), 4);
    EXPECT_NEAR(deg_from_rad(wedge.edge_slopes_rad[k]), 90 - angle_deg(edge, Eigen::Vector3d::UnitZ()), 5);
    EXPECT_NEAR(deg_from_rad(wedge.face_slopes_rad[k]), angle_deg(pit.normal(k), Eigen::Vector3d::UnitZ()),
                5);
    EXPECT_NEAR(wedge.edge_lengths_mm[k], edge.norm(), 0.3);
  }
}

TEST(HollowMeasure, HowFarOffTheLastContactIsNobodyKnows) {
  WedgeOptions options;
  options.exits = ExitDefinition::kExtent;
  const Wedge at_surface = hollow().measured(hollow().vertices, {});
  const Wedge seen_last = hollow().measured(hollow().vertices, options);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GT(at_surface.sigma.length_mm[k], 0);
    EXPECT_TRUE(std::isnan(seen_last.sigma.length_mm[k]));
  }
  EXPECT_GT(at_surface.sigma.volume_mm3, 0);
  EXPECT_TRUE(std::isnan(seen_last.sigma.volume_mm3));
  EXPECT_EQ(seen_last.sigma.depth_mm, at_surface.sigma.depth_mm);
}

TEST(HollowMeasure, WhereTheMeshEndsBeforeAnEdgeDoesNobodyKnowsItsLength) {
  // The sheet ends at x = 0.8; the tail comes out at 2.
  Hollow cut = hollow();
  std::erase_if(cut.mesh.faces, [&](const auto& face) {
    return std::ranges::any_of(face, [&](std::uint32_t v) { return cut.mesh.positions[v].x() > 0.8F; });
  });
  cut.graph = make_vertex_graph(cut.mesh);
  cut.areas = vertex_areas(cut.mesh, cut.graph);
  std::erase_if(cut.vertices, [&](std::uint32_t v) { return cut.graph.ring(v).empty(); });
  const Wedge whole = hollow().measured(hollow().vertices, {});
  const Wedge wedge = cut.measured(cut.vertices, {});
  ASSERT_GT(wedge.exit_points_surface_mm[0].x(), 1.5);
  EXPECT_EQ(wedge.beyond_mesh, (std::array{true, false, false}));
  EXPECT_EQ(whole.beyond_mesh, (std::array{false, false, false}));
  EXPECT_TRUE(length_is_guess(wedge, 0));
  WedgeOptions to_last_contact;
  to_last_contact.exits = ExitDefinition::kExtent;
  const Wedge seen_last = cut.measured(cut.vertices, to_last_contact);
  EXPECT_EQ(seen_last.beyond_mesh, wedge.beyond_mesh);
  EXPECT_FALSE(length_is_guess(seen_last, 0)) << "it ends on the mesh";
  EXPECT_LT(wedge.faces_intact[0], whole.faces_intact[0]) << "its outer end is gone";
  EXPECT_TRUE(std::isnan(wedge.sigma.length_mm[0]));
  EXPECT_TRUE(std::isnan(wedge.sigma.volume_mm3));
  EXPECT_GT(wedge.sigma.length_mm[1], 0);
  EXPECT_GT(wedge.sigma.length_mm[2], 0);
  EXPECT_GT(whole.sigma.length_mm[0], 0);
}

/// A box 10 mm thick with a pit in its upper side whose three steep faces meet 9 mm below it, of which the
/// first 3 mm are there: the nearest surface to that place is the lower side.
TEST(HollowMeasure, DepthIsBelowTheSideThatAHoleIsIn) {
  Hollow shaft;
  shaft.mesh = shapes::box({8, 8, 5}, 160);
  const auto hole = [](const Eigen::Vector3f& p) {
    const float out = std::max({p.x(), -0.5F * p.x() + 0.866F * p.y(), -0.5F * p.x() - 0.866F * p.y()});
    return std::min(0.0F, std::max(-3.0F, 9.0F * (out / 0.9F - 1.0F)));
  };
  for (Eigen::Vector3f& p : shaft.mesh.positions) {
    p.z() += p.z() > 4.999F ? hole(p) : 0.0F;
  }
  shaft.mesh.normals = vertex_normals(shaft.mesh);
  shaft.graph = make_vertex_graph(shaft.mesh);
  shaft.fields = *compute_surface_fields(shaft.mesh, shaft.graph, {}, {});
  shaft.areas = vertex_areas(shaft.mesh, shaft.graph);
  for (std::uint32_t v = 0; v < shaft.mesh.positions.size(); ++v) {
    const Eigen::Vector3f& p = shaft.mesh.positions[v];
    if (p.z() < 4.95F && p.z() > 1.9F && p.head<2>().norm() < 2) {
      shaft.vertices.push_back(v);
    }
  }
  std::ranges::stable_sort(shaft.vertices, {}, [&](std::uint32_t v) { return shaft.fields.height_mm[v]; });
  const HollowMeasure measure(shaft.mesh, shaft.graph, shaft.fields, {}, shaft.areas, false);
  std::vector<std::int32_t> slot(shaft.mesh.positions.size(), -1);
  const auto found = measure.measure(shaft.vertices, &slot);
  ASSERT_TRUE(found) << found.error();
  const Wedge& wedge = found->wedge;
  ASSERT_GT(wedge.surface_normal.z(), 0.9);
  ASSERT_LT(wedge.depth_point_mm.z(), -1) << "nearer to the lower side";
  EXPECT_NEAR(wedge.depth_mm, 5 - wedge.depth_point_mm.z(), 0.3);
}

TEST(HollowMeasure, WhatIsLeftOfABasinAfterFourLooksIsSaid) {
  // Six pits in two rows, taken for one basin; the deepest first.
  const pits::Pit pit;
  const auto floor = [&](double x, double y) {
    double z = 0;
    for (int k = 0; k < 6; ++k) {
      z = std::min(z, (1 - 0.02 * k) * pit.floor(x - 4.0 * (k % 3 - 1), y - 3.0 * (k / 3) + 1.5));
    }
    return z;
  };
  Hollow h;
  h.mesh = pits::sheet(16, 0.08, floor);
  h.graph = make_vertex_graph(h.mesh);
  h.fields = *compute_surface_fields(h.mesh, h.graph, {}, {});
  h.areas = vertex_areas(h.mesh, h.graph);
  for (std::uint32_t v = 0; v < h.mesh.positions.size(); ++v) {
    if (h.mesh.positions[v].z() < -0.03F) {
      h.vertices.push_back(v);
    }
  }
  std::ranges::stable_sort(h.vertices, {}, [&](std::uint32_t v) { return h.fields.height_mm[v]; });
  const WedgeOptions options;
  const HollowMeasure measure(h.mesh, h.graph, h.fields, options, h.areas, false);
  std::vector<std::int32_t> slot(h.mesh.positions.size(), -1);
  const std::vector<WedgeCandidate> found = measure.look_at(h.vertices, &slot);
  ASSERT_EQ(found.size(), 6U);
  for (std::size_t k = 0; k < found.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_EQ(found[k].rejected, k < 4 ? "" : "not looked at: four others of its basin were");
    EXPECT_EQ(found[k].hollow_mm2 > 0, k < 4) << "nobody knows what company it is";
    EXPECT_LT(found[k].wedge.depth_point_mm.z(), -0.4) << "its lowest place";
  }
}

}  // namespace
}  // namespace dubsar
