// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What else lies in a mesh, and how it is numbered, changes no wedge.

#include "analysis/mesh_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "analysis/text_frame.h"
#include "analysis/wedges.h"
#include "core/random.h"
#include "core/units.h"
#include "sim/tablet.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

std::vector<Wedge> wedges_of(const Mesh& mesh) {
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(mesh);
  const SurfaceFields fields = compute_surface_fields(mesh, graph, {}, job).value();
  return find_wedges(mesh, graph, fields, {}, job).value().wedges;
}

/// Its positions and faces alone.
Mesh tablet(int seed, const Eigen::Vector3d& size_mm, double spacing_mm, const sim::DamageOptions& damage) {
  sim::TabletOptions options;
  options.seed = static_cast<std::uint64_t>(seed);
  options.size_mm = size_mm;
  options.spacing_mm = spacing_mm;
  options.damage = damage;
  JobContext job;
  Mesh made = sim::make_tablet(options, job).value().mesh;
  Mesh mesh;
  mesh.positions = std::move(made.positions);
  mesh.faces = std::move(made.faces);
  return mesh;
}

Mesh shifted(Mesh mesh, const Eigen::Vector3f& by) {
  for (Eigen::Vector3f& p : mesh.positions) {
    p += by;
  }
  return mesh;
}

/// The faces and vertices of both.
Mesh together(const Mesh& one, const Mesh& other) {
  Mesh both;
  both.positions = one.positions;
  both.faces = one.faces;
  const auto first = static_cast<std::uint32_t>(one.positions.size());
  both.positions.insert(both.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.faces) {
    both.faces.push_back({a + first, b + first, c + first});
  }
  return both;
}

MeshBodies bodies_of(const Mesh& mesh) {
  return find_bodies(mesh, make_vertex_geometry(mesh, make_vertex_graph(mesh)));
}

Mesh turned_over(Mesh mesh) {
  for (Eigen::Vector3f& p : mesh.positions) {
    p = Eigen::Vector3f(p.x(), -p.y(), -p.z());
  }
  return mesh;
}

TEST(MeshBodies, AreWhatIsClosedByItselfAndWhatLooksTheSameWaySideBySide) {
  const Mesh ball = shapes::sphere(5, 4);
  const Mesh small = shapes::sphere(4, 4);
  EXPECT_EQ(bodies_of(ball).count, 1U);
  EXPECT_TRUE(bodies_of(ball).of.empty());
  const MeshBodies two = bodies_of(together(small, shifted(ball, {9.5F, 0, 0})));
  EXPECT_EQ(two.count, 2U);
  EXPECT_EQ(two.of.front(), 1);  // the larger is the first
  EXPECT_EQ(two.of.back(), 0);
  // A scrap goes with what it lies at.
  EXPECT_EQ(bodies_of(together(ball, shifted(shapes::sphere(0.2F, 2), {6, 0, 0}))).count, 1U);

  const Mesh sheet = shapes::sheet(5, 20, [](float, float) { return 0.0F; });
  EXPECT_EQ(bodies_of(together(sheet, shifted(sheet, {20, 0, 0}))).count, 2U);
  EXPECT_EQ(bodies_of(together(sheet, shifted(sheet, {10.5F, 0, 0}))).count, 1U);  // a crack between
  // Obverse and reverse, scanned from two sides.
  EXPECT_EQ(bodies_of(together(sheet, shifted(turned_over(sheet), {0, 0, -10}))).count, 1U);
  EXPECT_EQ(bodies_of(together(ball, shifted(sheet, {0, 0, 6}))).count, 1U);
  EXPECT_EQ(bodies_of(together(ball, shifted(sheet, {0, 0, 20}))).count, 2U);
}

void expect_same(const Wedge& a, const Wedge& b) {
  EXPECT_EQ(a.depth_point_mm, b.depth_point_mm);
  EXPECT_EQ(a.depth_mm, b.depth_mm);
  EXPECT_EQ(a.volume_mm3, b.volume_mm3);
  EXPECT_EQ(a.exit_points_mm, b.exit_points_mm);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.sigma.depth_mm, b.sigma.depth_mm);
}

TEST(MeshBodies, OfTwoTabletsInOneMeshAreThoseOfEachAloneAndNoLineRunsOverBoth) {
  const Mesh one = tablet(12, {24, 20, 10}, 0.1, sim::DamageOptions::none());
  // Smaller, so that it comes second, and close by: each hides the sky from the other.
  const Mesh other = shifted(tablet(5, {20, 18, 9}, 0.12, sim::DamageOptions::none()), {26, 0, 0});
  const std::vector<Wedge> first = wedges_of(one);
  const std::vector<Wedge> second = wedges_of(other);
  ASSERT_GT(second.size(), 50U);
  const Mesh mesh = together(one, other);
  std::vector<Wedge> both = wedges_of(mesh);
  ASSERT_EQ(both.size(), first.size() + second.size());
  for (std::size_t i = 0; i < both.size(); ++i) {
    SCOPED_TRACE(i);
    const bool is_first = i < first.size();  // one after the other
    EXPECT_EQ(both[i].id, static_cast<int>(i));
    EXPECT_EQ(both[i].place.body, is_first ? 1 : 2);
    const std::vector<Wedge>& alone = is_first ? first : second;  // where lines may be other ones
    const auto same = std::ranges::find(alone, both[i].depth_point_mm, &Wedge::depth_point_mm);
    ASSERT_NE(same, alone.end());
    expect_same(both[i], *same);
  }
  place_wedges(find_text_frame(mesh, both), &both);
  std::map<std::pair<Face, int>, int> body_of_line;
  for (const Wedge& w : both) {
    const auto at = std::pair(*w.place.side, w.place.line);
    EXPECT_EQ(body_of_line.try_emplace(at, w.place.body).first->second, w.place.body);
  }
}

/// Everything that corrections rest on.
struct Analysed {
  Mesh mesh;
  VertexGraph graph;
  SurfaceFields fields;
  WedgeFindings findings;

  explicit Analysed(Mesh what) : mesh(std::move(what)), graph(make_vertex_graph(mesh)) {
    const JobContext job;
    fields = compute_surface_fields(mesh, graph, {}, job).value();
    findings = find_candidates(mesh, graph, fields, {}, job).value();
  }
  [[nodiscard]] WedgeSet corrected(const std::vector<WedgeCorrection>& said) const {
    WedgeOptions options;
    options.corrections = said;
    return settle_wedges(mesh, graph, fields, options, findings);
  }
};

TEST(MeshBodies, AWedgeThatAPersonAddsIsMeasuredByTheNoiseOfItsOwnBody) {
  const Mesh one = tablet(12, {16, 14, 8}, 0.1, sim::DamageOptions::none());
  Mesh rough = shifted(tablet(5, {12, 10, 7}, 0.1, sim::DamageOptions::none()), {30, 0, 0});
  Random random(2);
  for (Eigen::Vector3f& p : rough.positions) {
    p += (0.02 * random.normal3()).cast<float>();
  }
  const Analysed alone(one);
  const Analysed both(together(one, rough));
  ASSERT_EQ(both.fields.body_count(), 2U);
  std::size_t compared = 0;
  const WedgeSet found = alone.corrected({});
  for (const Wedge& wedge : found.wedges) {
    if (compared == 5) {
      break;
    }
    WedgeCorrection gone;
    gone.at_mm = {wedge.depth_point_mm};
    WedgeCorrection added;
    added.kind = CorrectionKind::kAdd;
    added.region_mm = gone.at_mm;
    added.reach_mm = 1.0;
    const WedgeSet right = alone.corrected({gone, added});
    if (!right.lost.empty()) {
      continue;
    }
    ++compared;
    const WedgeSet set = both.corrected({gone, added});
    const auto by_hand = [](const WedgeSet& of) {
      return *std::ranges::find(of.wedges, ByHand::kAdded, &Wedge::by_hand);
    };
    ASSERT_TRUE(set.lost.empty()) << set.lost.front().reason;
    EXPECT_LT((by_hand(set).depth_point_mm - by_hand(right).depth_point_mm).norm(), 1e-6) << wedge.id;
    EXPECT_NEAR(by_hand(set).volume_mm3, by_hand(right).volume_mm3, 1e-6) << wedge.id;
  }
  EXPECT_GT(compared, 0U);
}

TEST(MeshBodies, AScrapAnywhereChangesNoMeasureByAMicrometre) {
  const Mesh mesh = tablet(12, {24, 20, 10}, 0.1, sim::DamageOptions::none());
  const std::vector<Wedge> alone = wedges_of(mesh);
  ASSERT_GT(alone.size(), 50U);
  for (const float away : {1.0F, 3.0F, 150.0F}) {
    Mesh scrap;
    const float x = 12 + away;
    scrap.positions = {{x, 0, 0}, {x + 0.1F, 0, 0}, {x, 0.1F, 0}};
    scrap.faces = {{0, 1, 2}};
    const std::vector<Wedge> beside = wedges_of(together(mesh, scrap));
    ASSERT_EQ(beside.size(), alone.size()) << away;
    for (const Wedge& w : alone) {
      const auto same = std::ranges::min_element(
          beside, {}, [&](const Wedge& o) { return (o.depth_point_mm - w.depth_point_mm).norm(); });
      EXPECT_NEAR(same->depth_mm, w.depth_mm, 1e-3) << away << ' ' << w.id;
      EXPECT_NEAR(same->volume_mm3 / w.volume_mm3, 1, 1e-2) << away << ' ' << w.id;
      EXPECT_EQ(same->place.body, 0);
    }
  }
}

TEST(MeshBodies, AreTheSameHoweverTheVerticesAreNumbered) {
  const Mesh mesh = tablet(12, {24, 20, 10}, 0.1, {});
  const std::vector<Wedge> alone = wedges_of(mesh);
  ASSERT_GT(alone.size(), 50U);
  Random random(1);
  std::vector<std::uint32_t> place(mesh.positions.size());
  std::iota(place.begin(), place.end(), 0U);
  for (std::size_t k = place.size(); k > 1; --k) {
    std::swap(place[k - 1], place[random.below(k)]);
  }
  Mesh shuffled = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) {
    shuffled.positions[place[v]] = mesh.positions[v];
  }
  for (std::size_t k = shuffled.faces.size(); k > 1; --k) {
    std::swap(shuffled.faces[k - 1], shuffled.faces[random.below(k)]);
  }
  for (auto& face : shuffled.faces) {
    face = {place[face[0]], place[face[1]], place[face[2]]};
  }
  const std::vector<Wedge> again = wedges_of(shuffled);
  ASSERT_EQ(again.size(), alone.size());
  for (const Wedge& w : alone) {
    const auto same = std::ranges::min_element(
        again, {}, [&](const Wedge& o) { return (o.depth_point_mm - w.depth_point_mm).norm(); });
    SCOPED_TRACE(w.id);
    EXPECT_NEAR(same->depth_mm, w.depth_mm, 5e-5);
    EXPECT_NEAR(same->volume_mm3 / w.volume_mm3, 1, 2e-3);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR((same->exit_points_mm[k] - w.exit_points_mm[k]).norm(), 0, 2e-3);
      EXPECT_NEAR(deg_from_rad(same->edge_slopes_rad[k] - w.edge_slopes_rad[k]), 0, 0.02);
    }
  }
}

}  // namespace
}  // namespace dubsar
