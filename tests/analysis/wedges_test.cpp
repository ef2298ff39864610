// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The whole chain, from a mesh to wedges, on simulated tablets and on things that hold none.

#include "analysis/wedges.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>

#include "analysis/text_frame.h"
#include "sim/tablet.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

WedgeSet wedges_of(const Mesh& mesh) {
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(mesh);
  const auto fields = compute_surface_fields(mesh, graph, {}, job);
  EXPECT_TRUE(fields);
  auto set = find_wedges(mesh, graph, *fields, {}, job);
  EXPECT_TRUE(set);
  return *std::move(set);
}

sim::SimTablet tablet(double text_density, const sim::DamageOptions& damage) {
  sim::TabletOptions options;
  options.seed = 12;
  options.size_mm = {30, 26, 12};
  options.spacing_mm = 0.1;
  options.text_density = text_density;
  options.damage = damage;
  JobContext job;
  auto made = sim::make_tablet(options, job);
  EXPECT_TRUE(made);
  return *std::move(made);
}

/// Index of the true wedge within 0.3 mm of each found one, or -1.
std::vector<int> pairs(const std::vector<Wedge>& found, const std::vector<Wedge>& truth) {
  std::vector<int> of(found.size(), -1);
  for (std::size_t f = 0; f < found.size(); ++f) {
    double nearest = 0.3;
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double d = (found[f].depth_point_mm - truth[t].depth_point_mm).norm();
      if (d < nearest) {
        nearest = d;
        of[f] = static_cast<int>(t);
      }
    }
  }
  return of;
}

TEST(Wedges, OfACleanTabletAreFoundAndMeasured) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  const WedgeSet set = wedges_of(made.mesh);
  const std::vector<int> of = pairs(set.wedges, made.wedges);
  std::vector<std::uint8_t> hit(made.wedges.size(), 0);
  int false_ones = 0;
  int directional = 0;
  for (std::size_t f = 0; f < of.size(); ++f) {
    if (of[f] < 0) {
      ++false_ones;
      continue;
    }
    const Wedge& found = set.wedges[f];
    const Wedge& truth = made.wedges[static_cast<std::size_t>(of[f])];
    hit[static_cast<std::size_t>(of[f])] = 1;
    const auto tail = [](const Wedge& w) {
      return (w.exit_points_mm[static_cast<std::size_t>(w.directional_edge)] - w.depth_point_mm).normalized();
    };
    directional += tail(found).dot(tail(truth)) > 0.95 ? 1 : 0;
    EXPECT_NEAR(found.depth_mm, truth.depth_mm, 0.2);
    EXPECT_GT(found.confidence, 0.0);
    EXPECT_LE(found.confidence, 1.0);
  }
  int whole = 0;
  int missed = 0;
  for (std::size_t t = 0; t < hit.size(); ++t) {
    whole += made.wedges[t].intact >= 0.6 ? 1 : 0;
    missed += made.wedges[t].intact >= 0.6 && hit[t] == 0 ? 1 : 0;
  }
  ASSERT_GT(whole, 50);
  EXPECT_LE(missed, 0.05 * whole);
  EXPECT_LE(false_ones, 0.05 * whole);
  EXPECT_GE(directional, 0.9 * static_cast<double>(of.size() - static_cast<std::size_t>(false_ones)));
}

TEST(Wedges, AreTheSameForAnyNumberOfThreads) {
  const sim::SimTablet made = tablet(0.6, {});
  const WedgeSet many = wedges_of(made.mesh);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const WedgeSet few = wedges_of(made.mesh);
  ASSERT_EQ(many.wedges.size(), few.wedges.size());
  ASSERT_EQ(many.rejected.size(), few.rejected.size());
  EXPECT_EQ(many.basin_of, few.basin_of);
  EXPECT_EQ(many.wedge_of, few.wedge_of);
  for (std::size_t i = 0; i < many.wedges.size(); ++i) {
    EXPECT_EQ(many.wedges[i].depth_point_mm, few.wedges[i].depth_point_mm);
    EXPECT_EQ(many.wedges[i].exit_points_mm, few.wedges[i].exit_points_mm);
    EXPECT_EQ(many.wedges[i].confidence, few.wedges[i].confidence);
  }
}

TEST(Wedges, ThereAreNoneOnABlankTabletAndASphere) {
  EXPECT_TRUE(wedges_of(tablet(0.0, sim::DamageOptions::none()).mesh).wedges.empty());
  Mesh sphere = shapes::unit_sphere(6);
  for (Eigen::Vector3f& p : sphere.positions) {
    p *= 15.0F;
  }
  EXPECT_TRUE(wedges_of(sphere).wedges.empty());
  EXPECT_TRUE(wedges_of(shapes::unit_sphere(0)).wedges.empty());
}

TEST(Wedges, StandInLinesAsTheyWereWritten) {
  const sim::SimTablet made = tablet(1.0, sim::DamageOptions::none());
  WedgeSet set = wedges_of(made.mesh);
  const TextFrame frame = find_text_frame(made.mesh, set.wedges);
  EXPECT_GT(frame.certainty, 0.2);
  // The reader's right is the tablet's x, whichever broad side was taken for the obverse.
  EXPECT_GT((frame.text_from_model.rotation.row(0) * Eigen::Vector3d::UnitX()).value(), 0.95);
  place_wedges(frame, &set.wedges);
  const std::vector<int> of = pairs(set.wedges, made.wedges);
  // True wedges are numbered as they were written: along a line the numbers rise, but for strokes of a sign.
  std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> lines;
  for (std::size_t f = 0; f < of.size(); ++f) {
    const WedgePlace& place = set.wedges[f].place;
    ASSERT_TRUE(place.side);
    ASSERT_GT(place.line, 0);
    if (of[f] >= 0 && (*place.side == Face::kObverse || *place.side == Face::kReverse)) {
      lines[{static_cast<int>(*place.side), place.line}].emplace_back(place.order, of[f]);
    }
  }
  ASSERT_GT(lines.size(), 4U);
  int pairs_seen = 0;
  int rising = 0;
  for (auto& [key, line] : lines) {
    std::ranges::sort(line);
    for (std::size_t i = 5; i < line.size(); ++i) {
      ++pairs_seen;
      rising += line[i].second > line[i - 5].second ? 1 : 0;
    }
  }
  EXPECT_GT(rising, 0.85 * pairs_seen);
}

}  // namespace
}  // namespace dubsar
