// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a person says of wedges, made on a simulated tablet whose true wedges are known.

#include "analysis/wedge_corrections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include "core/units.h"
#include "sim/tablet.h"

namespace dubsar {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Found once for all tests.
struct Found {
  Mesh mesh;
  VertexGraph graph;
  SurfaceFields fields;
  WedgeFindings findings;
  WedgeSet set;  ///< before any correction
};

const Found& found() {
  static const std::unique_ptr<const Found> kFound = [] {
    auto out = std::make_unique<Found>();
    sim::TabletOptions options;
    options.seed = 12;
    options.size_mm = {24, 20, 10};
    options.spacing_mm = 0.1;
    options.damage = sim::DamageOptions::none();
    JobContext job;
    out->mesh = sim::make_tablet(options, job)->mesh;
    out->graph = make_vertex_graph(out->mesh);
    out->fields = *compute_surface_fields(out->mesh, out->graph, {}, job);
    out->findings = *find_candidates(out->mesh, out->graph, out->fields, {}, job);
    out->set = settle_wedges(out->mesh, out->graph, out->fields, {}, out->findings);
    return out;
  }();
  return *kFound;
}

WedgeSet corrected(std::vector<WedgeCorrection> corrections) {
  WedgeOptions options;
  options.corrections = std::move(corrections);
  return settle_wedges(found().mesh, found().graph, found().fields, options, found().findings);
}

WedgeCorrection delete_of(std::initializer_list<int> ids) {
  WedgeCorrection out;
  for (const int id : ids) {
    out.at_mm.push_back(found().set.wedges[static_cast<std::size_t>(id)].depth_point_mm);
  }
  return out;
}

/// A wedge is where these vertices are.
WedgeCorrection add_at(const std::vector<std::uint32_t>& vertices) {
  WedgeCorrection out;
  out.kind = CorrectionKind::kAdd;
  out.reach_mm = 0.02;
  for (const std::uint32_t v : vertices) {
    out.region_mm.push_back(found().mesh.positions[v].cast<double>());
  }
  return out;
}

std::vector<std::uint32_t> vertices_of(const WedgeSet& set, int id) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < set.wedge_of.size(); ++v) {
    if (set.wedge_of[v] == id) {
      out.push_back(v);
    }
  }
  return out;
}

const Wedge* wedge_of_id(const WedgeSet& set, int id) {
  const auto at = std::ranges::find(set.wedges, id, &Wedge::id);
  return at == set.wedges.end() ? nullptr : &*at;
}

/// All wedges but these are the same, to the bit.
void expect_others_untouched(const WedgeSet& set, std::initializer_list<int> changed) {
  for (const Wedge& before : found().set.wedges) {
    const Wedge* now = wedge_of_id(set, before.id);
    if (std::ranges::find(changed, before.id) != changed.end()) {
      EXPECT_EQ(now, nullptr) << before.id;
      continue;
    }
    ASSERT_NE(now, nullptr) << before.id;
    EXPECT_EQ(now->depth_point_mm, before.depth_point_mm);
    EXPECT_EQ(now->opening_angles_rad, before.opening_angles_rad);
    EXPECT_EQ(now->confidence, before.confidence);
    EXPECT_EQ(now->by_hand, ByHand::kNo);
  }
  EXPECT_EQ(set.evidence.size(), set.wedges.size());
}

/// The wedge with most vertices whose basin holds no other.
int lone_wedge() {
  const WedgeSet& set = found().set;
  int best = -1;
  for (const Wedge& w : set.wedges) {
    const std::int32_t basin = set.basin_of[vertices_of(set, w.id).front()];
    bool alone = true;
    for (std::size_t v = 0; v < set.basin_of.size() && alone; ++v) {
      alone = set.basin_of[v] != basin || set.wedge_of[v] < 0 || set.wedge_of[v] == w.id;
    }
    if (alone && (best < 0 || w.vertex_count > wedge_of_id(set, best)->vertex_count)) {
      best = w.id;
    }
  }
  return best;
}

TEST(WedgeCorrections, WhatIsDeletedIsListedAndNothingElseChanges) {
  const WedgeSet set = corrected({delete_of({4, 7})});
  EXPECT_THAT(set.lost, IsEmpty());
  EXPECT_EQ(set.wedges.size(), found().set.wedges.size() - 2);
  expect_others_untouched(set, {4, 7});
  EXPECT_EQ(set.rejected.size(), found().set.rejected.size() + 2);
  EXPECT_EQ(set.rejected.back().reason, "deleted by hand");
  EXPECT_THAT(vertices_of(set, 4), IsEmpty());
}

TEST(WedgeCorrections, AMissedWedgeIsMeasuredAsItWouldHaveBeen) {
  const int id = lone_wedge();
  ASSERT_GE(id, 0);
  const Wedge before = *wedge_of_id(found().set, id);
  const WedgeSet set = corrected({delete_of({id}), add_at(vertices_of(found().set, id))});
  ASSERT_THAT(set.lost, IsEmpty());
  expect_others_untouched(set, {id});
  const Wedge& added = set.wedges.back();
  EXPECT_EQ(added.by_hand, ByHand::kAdded);
  EXPECT_EQ(added.id, static_cast<int>(found().set.wedges.size())) << "ids are not used twice";
  EXPECT_LT((added.depth_point_mm - before.depth_point_mm).norm(), 0.03);
  for (const double opening : before.opening_angles_rad) {
    EXPECT_TRUE(std::ranges::any_of(added.opening_angles_rad,
                                    [&](double now) { return std::abs(now - opening) < 0.06; }));
  }
  EXPECT_GT(added.confidence, 0.5);
  EXPECT_GT(vertices_of(set, added.id).size(), 0.8 * before.vertex_count);
}

TEST(WedgeCorrections, GoByTheirOwnBodyAlone) {
  const int id = lone_wedge();
  ASSERT_GE(id, 0);
  const std::vector<std::uint32_t> its = vertices_of(found().set, id);
  SurfaceFields fields = found().fields;  // as if its clay were a body of its own
  fields.further_surfaces = {fields.surface};
  fields.body_of.assign(found().mesh.positions.size(), 0);
  for (const std::uint32_t v : its) {
    fields.body_of[v] = 1;
  }
  const Eigen::Vector3d place = wedge_of_id(found().set, id)->depth_point_mm;
  WedgeFindings findings = found().findings;
  ASSERT_EQ(findings.is_noisy.front(), 0);
  findings.is_noisy.push_back(0);
  for (WedgeCandidate& c : findings.candidates) {
    c.wedge.place.body = c.wedge.depth_point_mm == place ? 2 : 1;
  }
  WedgeFindings alone = findings;
  std::erase_if(alone.candidates, [](const WedgeCandidate& c) { return c.wedge.place.body == 1; });
  ASSERT_EQ(alone.candidates.size(), 1U);
  findings.is_noisy.front() = 1;  // of the other
  WedgeOptions options;
  options.corrections = {delete_of({id}), add_at(its)};
  const auto added = [&](const WedgeFindings& of) {
    const WedgeSet set = settle_wedges(found().mesh, found().graph, fields, options, of);
    EXPECT_THAT(set.lost, IsEmpty());
    const auto at = std::ranges::find(set.wedges, ByHand::kAdded, &Wedge::by_hand);
    return at == set.wedges.end() ? Wedge() : *at;
  };
  const Wedge expected = added(alone);
  const Wedge beside = added(findings);
  EXPECT_GT(expected.confidence, 0);
  EXPECT_EQ(beside.confidence, expected.confidence) << "what lies on another body says nothing of it";
  EXPECT_EQ(beside.depth_point_mm, expected.depth_point_mm) << "nor does the noise there";
}

TEST(WedgeCorrections, ASplitLooksAroundItsPlacesAsItsOwnBodyIsSpaced) {
  const int id = lone_wedge();
  ASSERT_GE(id, 0);
  SurfaceFields fields = found().fields;
  fields.further_surfaces = {fields.surface};
  const Wedge& wedge = *wedge_of_id(found().set, id);
  fields.body_of.assign(found().mesh.positions.size(), 0);
  for (std::size_t v = 0; v < fields.body_of.size(); ++v) {
    const double far_mm = (found().mesh.positions[v].cast<double>() - wedge.depth_point_mm).norm();
    fields.body_of[v] = far_mm < 8.0 ? 1 : 0;
  }
  WedgeFindings findings = found().findings;
  findings.is_noisy.push_back(0);
  for (std::size_t v = 0; v < fields.body_of.size(); ++v) {
    findings.area_mm2[v] *= fields.body_of[v] == 0 ? 1000.0F : 1.0F;  // as of a coarse mesh
  }
  WedgeOptions options;
  WedgeCorrection& split = options.corrections.emplace_back();
  split.kind = CorrectionKind::kSplit;
  split.at_mm = {wedge.depth_point_mm};
  split.into_mm.assign(2, wedge.depth_point_mm + 2.0 * wedge.surface_normal);  // in the air
  const WedgeSet set = settle_wedges(found().mesh, found().graph, fields, options, findings);
  ASSERT_EQ(set.lost.size(), 1U);
  EXPECT_THAT(set.lost.front().reason, HasSubstr("does not lie in the wedge: number 1"));
}

TEST(WedgeCorrections, JudgeTheirOwnWedgeAloneAsItWouldBeAmongAll) {
  std::vector<WedgeCandidate> all = found().findings.candidates;
  std::erase_if(all, [](const WedgeCandidate& c) { return !c.rejected.empty(); });
  ASSERT_GT(all.size(), 20U);
  std::vector<WedgeCandidate> last = all;
  for (WedgeCandidate& c : last) {
    c.wedge.confidence = -1;
  }
  judge_wedges({}, &all);
  judge_last_wedge({}, &last);
  EXPECT_EQ(last.back().wedge.confidence, all.back().wedge.confidence);
  EXPECT_EQ(last.back().evidence, all.back().evidence);
  last.pop_back();
  EXPECT_TRUE(std::ranges::all_of(last, [](const WedgeCandidate& c) { return c.wedge.confidence == -1; }))
      << "each of thousands takes as long as there are others to compare it with";
}

/// Deletes a wedge and adds it in two halves, cut by a plane through its depth point, the way that gives two
/// wedges; nothing where no way does.
std::vector<WedgeCorrection> in_halves(const Wedge& wedge) {
  constexpr int kWays = 12;
  const Eigen::Vector3d x = wedge.surface_normal.unitOrthogonal();
  const Eigen::Vector3d y = wedge.surface_normal.cross(x);
  for (int way = 0; way < kWays; ++way) {
    const double turn = kPi * way / kWays;
    const Eigen::Vector3d across = std::cos(turn) * x + std::sin(turn) * y;
    std::vector<std::uint32_t> left;
    std::vector<std::uint32_t> right;
    for (const std::uint32_t v : vertices_of(found().set, wedge.id)) {
      const Eigen::Vector3d off = found().mesh.positions[v].cast<double>() - wedge.depth_point_mm;
      (off.dot(across) < 0 ? left : right).push_back(v);
    }
    std::vector<WedgeCorrection> said{delete_of({wedge.id}), add_at(left), add_at(right)};
    if (corrected(said).lost.empty()) {
      return said;
    }
  }
  return {};
}

TEST(WedgeCorrections, TheHalvesOfAWedgeAreMergedToTheWhole) {
  std::vector<WedgeCorrection> said;
  Wedge before;
  for (const Wedge& w : found().set.wedges) {
    if (said.empty() && w.vertex_count > 150) {
      before = w;
      said = in_halves(w);
    }
  }
  ASSERT_FALSE(said.empty()) << "no wedge's halves are measured";
  const WedgeSet parts = corrected(said);
  const std::size_t count = found().set.wedges.size();
  ASSERT_EQ(parts.wedges.size(), count + 1);
  WedgeCorrection merge;
  merge.kind = CorrectionKind::kMerge;
  merge.at_mm = {parts.wedges[count - 1].depth_point_mm, parts.wedges[count].depth_point_mm};
  said.push_back(merge);
  const WedgeSet merged = corrected(said);
  ASSERT_THAT(merged.lost, IsEmpty()) << merged.lost.front().reason;
  expect_others_untouched(merged, {before.id});
  ASSERT_EQ(merged.wedges.size(), count);
  const Wedge& whole = merged.wedges.back();
  EXPECT_EQ(whole.by_hand, ByHand::kMerged);
  EXPECT_LT((whole.depth_point_mm - before.depth_point_mm).norm(), 0.05);
  EXPECT_GT(whole.vertex_count, 0.8 * before.vertex_count);
  const auto leading = static_cast<std::size_t>(before.directional_edge);
  EXPECT_NEAR(whole.edge_lengths_mm[static_cast<std::size_t>(whole.directional_edge)],
              before.edge_lengths_mm[leading], 0.1 * before.edge_lengths_mm[leading]);
}

TEST(WedgeCorrections, AHollowOfTwoIsSplitAtTheirDeepestPlaces) {
  // Two true wedges in one basin: told to be one, then split.
  const WedgeSet& set = found().set;
  int first = -1;
  int second = -1;
  for (const Wedge& w : set.wedges) {
    const std::int32_t basin = set.basin_of[vertices_of(set, w.id).front()];
    for (std::size_t v = 0; v < set.basin_of.size() && first < 0; ++v) {
      if (set.basin_of[v] == basin && set.wedge_of[v] >= 0 && set.wedge_of[v] != w.id) {
        first = w.id;
        second = set.wedge_of[v];
      }
    }
  }
  ASSERT_GE(first, 0) << "the tablet has wedges that run into each other";
  std::vector<std::uint32_t> both = vertices_of(set, first);
  std::ranges::copy(vertices_of(set, second), std::back_inserter(both));
  std::vector<WedgeCorrection> said{delete_of({first, second}), add_at(both)};
  const WedgeSet one = corrected(said);
  ASSERT_THAT(one.lost, IsEmpty()) << one.lost.front().reason;
  WedgeCorrection split;
  split.kind = CorrectionKind::kSplit;
  split.at_mm = {one.wedges.back().depth_point_mm};
  split.into_mm = delete_of({first, second}).at_mm;
  said.push_back(split);
  const WedgeSet two = corrected(said);
  ASSERT_THAT(two.lost, IsEmpty()) << two.lost.front().reason;
  expect_others_untouched(two, {first, second});
  ASSERT_EQ(two.wedges.size(), set.wedges.size());
  for (const int id : {first, second}) {
    double nearest = 1e9;
    for (const Wedge& w : two.wedges) {
      if (w.by_hand == ByHand::kSplit) {
        nearest = std::min(nearest, (w.depth_point_mm - wedge_of_id(set, id)->depth_point_mm).norm());
      }
    }
    EXPECT_LT(nearest, 0.1);
  }
}

TEST(WedgeCorrections, ASplitSaysOfAPlaceInThePartOfAnotherThatItLiesThere) {
  std::set<std::string> reasons;
  for (const Wedge& wedge : found().set.wedges) {
    WedgeCorrection split = delete_of({wedge.id});
    split.kind = CorrectionKind::kSplit;
    split.into_mm = {wedge.depth_point_mm, wedge.depth_point_mm};
    const WedgeSet set = corrected({split});
    for (const LostCorrection& lost : set.lost) {
      reasons.insert(lost.reason);
    }
    if (reasons.size() > 2) {
      break;
    }
  }
  EXPECT_THAT(reasons, Contains(HasSubstr("lies in the part of a place before it: number 2")));
}

TEST(WedgeCorrections, WhatCannotBeMadeSaysWhyAndChangesNothing) {
  const auto reason = [&](WedgeCorrection one) {
    const WedgeSet set = corrected({std::move(one)});
    expect_others_untouched(set, {});
    EXPECT_EQ(set.wedges.size(), found().set.wedges.size());
    EXPECT_EQ(set.wedge_of, found().set.wedge_of);
    return set.lost.empty() ? std::string() : set.lost.front().reason;
  };
  WedgeCorrection elsewhere = delete_of({3});
  elsewhere.at_mm[0].x() += 5 * kSamePlaceMm;
  elsewhere.at_mm[0].z() -= 5 * kSamePlaceMm;
  EXPECT_THAT(reason(elsewhere), HasSubstr("any more"));
  WedgeCorrection twice = delete_of({3, 3});
  twice.kind = CorrectionKind::kMerge;
  EXPECT_THAT(reason(twice), HasSubstr("one wedge already"));
  // Two wedges on opposite sides of the tablet.
  WedgeCorrection apart = delete_of({0});
  apart.kind = CorrectionKind::kMerge;
  const Wedge* farthest = &found().set.wedges.front();
  for (const Wedge& w : found().set.wedges) {
    farthest = (w.depth_point_mm - apart.at_mm[0]).norm() > (farthest->depth_point_mm - apart.at_mm[0]).norm()
                   ? &w
                   : farthest;
  }
  apart.at_mm.push_back(farthest->depth_point_mm);
  EXPECT_THAT(reason(apart), HasSubstr("wedge"));
  // What other wedges hold already.
  EXPECT_THAT(reason(add_at(vertices_of(found().set, 5))), HasSubstr("other wedges"));
  WedgeCorrection nowhere;
  nowhere.kind = CorrectionKind::kAdd;
  nowhere.region_mm = {{500, 0, 0}};
  nowhere.reach_mm = 1;
  EXPECT_THAT(reason(nowhere), HasSubstr("too few"));
  WedgeCorrection split = delete_of({2});
  split.kind = CorrectionKind::kSplit;
  split.into_mm = {split.at_mm[0], split.at_mm[0] + Eigen::Vector3d(9, 0, 0)};
  EXPECT_THAT(reason(split), HasSubstr("does not lie in the wedge"));
}

TEST(WedgeCorrections, OfADoubleThatABetterMeshShowsNoMoreTheTrueWedgeStays) {
  // Earlier another wedge was measured beside wedge 4, and deleted.
  WedgeOptions options;
  for (const Wedge& wedge : found().set.wedges) {
    options.earlier.wedges.push_back({wedge.id, wedge.depth_point_mm, ByHand::kNo});
  }
  WedgeCorrection of_double = delete_of({4});
  of_double.at_mm[0].x() += 0.6 * kSamePlaceMm;
  options.earlier.wedges.push_back({1000, of_double.at_mm[0], ByHand::kNo});
  options.corrections = {of_double};
  const auto settled = [&] {
    return settle_wedges(found().mesh, found().graph, found().fields, options, found().findings);
  };
  WedgeSet set = settled();
  ASSERT_EQ(set.lost.size(), 1U);
  EXPECT_THAT(set.lost.front().reason, HasSubstr("wedge 4 beside it is another"));
  expect_others_untouched(set, {});
  // Who means the true one by the place where it lay is heard.
  options.corrections = {of_double, delete_of({4})};
  set = settled();
  ASSERT_EQ(set.lost.size(), 1U);
  EXPECT_EQ(set.lost.front().index, 0U);
  expect_others_untouched(set, {4});
}

TEST(WedgeCorrections, OfAMeshMadeAnewTheyFindTheirPlacesAgain) {
  // The same tablet, every vertex moved a little: what was said of the one holds of the other.
  Mesh moved = found().mesh;
  for (std::size_t v = 0; v < moved.positions.size(); ++v) {
    const auto k = static_cast<float>(v % 17) / 17.0F - 0.5F;
    moved.positions[v] += 0.004F * Eigen::Vector3f(k, -k, 0.5F * k);
  }
  const int id = lone_wedge();
  WedgeOptions options;
  WedgeCorrection add = add_at(vertices_of(found().set, id));
  add.reach_mm = 0.15;
  options.corrections = {delete_of({id}), add};
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(moved);
  const auto fields = compute_surface_fields(moved, graph, {}, job);
  for (const Wedge& wedge : found().set.wedges) {  // under ids that say nothing of the order
    options.earlier.wedges.push_back({1000 - wedge.id, wedge.depth_point_mm, ByHand::kNo});
  }
  const auto set = find_wedges(moved, graph, *fields, options, job);
  ASSERT_TRUE(set);
  EXPECT_THAT(set->lost, IsEmpty()) << set->lost.front().reason;
  EXPECT_TRUE(std::ranges::is_sorted(set->wedges, {}, &Wedge::id));
  std::size_t same = 0;
  for (const Wedge& wedge : set->wedges) {
    if (const Wedge* before = wedge_of_id(found().set, 1000 - wedge.id)) {
      ++same;
      EXPECT_LE((before->depth_point_mm - wedge.depth_point_mm).norm(), kSamePlaceMm);
      EXPECT_NE(wedge.by_hand, ByHand::kAdded) << "what was measured is deleted, and its id with it";
    } else {
      EXPECT_GT(wedge.id, 1000) << "no id that another had";
    }
  }
  EXPECT_GE(same, found().set.wedges.size() * 9 / 10);
  const auto was_known = [](const auto& one) { return one.id <= 1000; };
  EXPECT_EQ(std::ranges::count_if(set->wedges, was_known) + std::ranges::count_if(set->former, was_known),
            std::ssize(found().set.wedges))
      << "none is forgotten";
  EXPECT_EQ(set->wedges.back().by_hand, ByHand::kAdded);
  EXPECT_LT((set->wedges.back().depth_point_mm - wedge_of_id(found().set, id)->depth_point_mm).norm(), 0.06);
}

}  // namespace
}  // namespace dubsar
