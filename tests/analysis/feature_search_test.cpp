// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/feature_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/wedge_features.h"
#include "core/random.h"
#include "core/units.h"

namespace dubsar {
namespace {

std::vector<std::vector<float>> random_rows(std::size_t count, std::size_t columns) {
  Random random(8);
  std::vector<std::vector<float>> rows(count);
  for (std::vector<float>& row : rows) {
    for (std::size_t k = 0; k < columns; ++k) {
      row.push_back(static_cast<float>(random.normal()));
    }
  }
  return rows;
}

TEST(FeatureSearch, IsExactInBothDistances) {
  const auto rows = random_rows(300, 11);
  const auto query = random_rows(301, 11).back();
  for (const FeatureDistance kind : {FeatureDistance::kL1, FeatureDistance::kL2}) {
    const auto distance = [&](const std::vector<float>& row) {
      double sum = 0;
      for (std::size_t k = 0; k < row.size(); ++k) {
        const double d = std::abs(row[k] - query[k]);
        sum += kind == FeatureDistance::kL1 ? d : d * d;
      }
      return kind == FeatureDistance::kL1 ? sum : std::sqrt(sum);
    };
    std::vector<double> all;
    for (const auto& row : rows) {
      all.push_back(distance(row));
    }
    std::ranges::sort(all);
    const auto found = FeatureSearch(rows, kind).nearest(query, 7);
    ASSERT_EQ(found.size(), 7U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].distance, all[i], 1e-4);
      EXPECT_NEAR(distance(rows[found[i].index]), found[i].distance, 1e-4);
    }
  }
}

TEST(FeatureSearch, ATreeThatWasKeptAnswersAlike) {
  const auto rows = random_rows(500, 11);
  const auto query = random_rows(501, 11).back();
  for (const FeatureDistance kind : {FeatureDistance::kL1, FeatureDistance::kL2}) {
    const FeatureSearch built(rows, kind);
    const auto kept = FeatureSearch::with_tree(rows, kind, built.tree());
    ASSERT_TRUE(kept);
    const auto a = built.nearest(query, 20);
    const auto b = kept->nearest(query, 20);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].index, b[i].index);
      EXPECT_EQ(a[i].distance, b[i].distance);
    }
    EXPECT_FALSE(FeatureSearch::with_tree(random_rows(499, 11), kind, built.tree()));
    EXPECT_FALSE(FeatureSearch::with_tree(rows, kind, ""));
    EXPECT_FALSE(FeatureSearch::with_tree(rows, kind, "no tree at all"));
  }
  EXPECT_TRUE(
      FeatureSearch::with_tree({}, FeatureDistance::kL1, FeatureSearch({}, FeatureDistance::kL1).tree()));
}

TEST(FeatureSearch, OfLittleAndOfNothing) {
  EXPECT_TRUE(FeatureSearch({}, FeatureDistance::kL1).nearest({1, 2}, 3).empty());
  const FeatureSearch two({{1, 2}, {5, 6}}, FeatureDistance::kL2);
  EXPECT_EQ(two.nearest({1, 2}, 10).size(), 2U);
  EXPECT_EQ(two.nearest({1, 2}, 10)[0].index, 0U);
  EXPECT_TRUE(two.nearest({1, 2, 3}, 1).empty());
}

/// Wedges of one hand, turned at random in the plane.
std::vector<Wedge> hand(double width, double depth, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Wedge> wedges;
  for (int i = 0; i < count; ++i) {
    Wedge w;
    w.id = i;
    const double turn = random.uniform(0, 2 * kPi);
    const double scale = 1 + 0.05 * random.normal();
    const std::array<Eigen::Vector2d, 3> exits = {Eigen::Vector2d(2.0, 0), Eigen::Vector2d(-0.3, 0.5 * width),
                                                  Eigen::Vector2d(-0.3, -0.5 * width)};
    w.depth_point_mm = {0, 0, -depth * scale};
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d at = scale * (Eigen::Rotation2Dd(turn) * exits[k]);
      w.exit_points_mm[k] = {at.x(), at.y(), 0};
    }
    w.directional_edge = 0;
    w.directional_margin = 0.5;
    w.place.side = Face::kObverse;
    w.place.turn_rad = 0;
    wedges.push_back(w);
  }
  return wedges;
}

TEST(WedgeFeatures, DoNotDependOnWhereAWedgePoints) {
  const std::vector<Wedge> one = hand(1.2, 0.5, 2, 3);
  const WedgeFeatures a = wedge_features(one[0]);
  Wedge renumbered = one[0];
  renumbered.directional_edge = 1;
  std::ranges::rotate(renumbered.exit_points_mm, renumbered.exit_points_mm.begin() + 2);
  EXPECT_EQ(wedge_features(renumbered), a);
}

TEST(WedgeProfile, OfOneHandIsNearerThanThatOfAnother) {
  const FeatureSearch search({comparable(hand(1.8, 0.5, 60, 1)), comparable(hand(1.2, 0.5, 60, 2)),
                              comparable(hand(1.2, 0.8, 60, 3))},
                             FeatureDistance::kL1);
  const auto found = search.nearest(comparable(hand(1.2, 0.5, 25, 9)), 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].index, 1U);
  EXPECT_GT(found[1].distance, 3 * found[0].distance);
}

TEST(WedgeProfile, CountsSidesAndKinds) {
  std::vector<Wedge> wedges = hand(1.2, 0.5, 10, 1);
  wedges[0].place = {Face::kReverse, 1, 1, rad_from_deg(-90)};
  wedges[1].directional_margin = 0.1;
  const auto profiles = make_profiles(wedges);
  ASSERT_EQ(profiles.size(), 3U);
  EXPECT_EQ(profiles[0].count, 10);
  EXPECT_EQ(profiles[1].count, 9);
  EXPECT_NEAR(profiles[0].kinds[0], 0.8, 1e-12);
  EXPECT_NEAR(profiles[0].kinds[1], 0.1, 1e-12);
  EXPECT_NEAR(profiles[0].kinds[4], 0.1, 1e-12);
  EXPECT_EQ(profiles[2].side, Face::kReverse);
  EXPECT_EQ(make_profiles({}).front().count, 0);
}

TEST(WedgeProfile, LeavesOutLengthsThatTheMeshEndsBefore) {
  std::vector<Wedge> wedges = hand(1.2, 0.5, 9, 1);
  const WedgeProfile whole = make_profiles(wedges).front();
  wedges.push_back(wedges[0]);
  wedges.back().beyond_mesh[0] = true;
  wedges.back().exit_points_mm[0] *= 100;
  wedges.back().edge_slopes_rad[0] = 0.3;
  const WedgeProfile profile = make_profiles(wedges).front();
  EXPECT_EQ(profile.count, 10);
  EXPECT_EQ(profile.beyond_mesh, 1);
  EXPECT_EQ(whole.beyond_mesh, 0);
  EXPECT_EQ(profile.quantiles[1], whole.quantiles[1]) << "of the nine";
  EXPECT_TRUE(std::isnan(wedge_features(wedges.back())[1]));
  Wedge risen = wedges[0];
  risen.exit_points_mm[0] = risen.depth_point_mm + Eigen::Vector3d(0.0, 0.0, risen.depth_mm / std::sin(0.3));
  EXPECT_NEAR(comparable(wedges.back())[1], comparable(risen)[1], 1e-5) << "as long as its slope says";
  EXPECT_EQ(profile.known[0], 10);
  EXPECT_EQ(profile.known[1], 9);
}

/// Of which no tail is on the mesh, as on a fragment; as long as depth and slope say all the same.
TEST(WedgeProfile, OfTabletsWithoutOneKnownLengthIsComparedByDepthAndSlope) {
  const auto broken = [](double slope_rad, std::uint64_t seed) {
    std::vector<Wedge> wedges = hand(1.2, 0.5, 12, seed);
    for (Wedge& wedge : wedges) {
      wedge.depth_mm = 0.5;
      wedge.beyond_mesh[0] = true;
      wedge.edge_slopes_rad[0] = slope_rad;
    }
    return wedges;
  };
  const auto mean_distance = [](const std::vector<Wedge>& a, const std::vector<Wedge>& b) {
    const std::vector<float> one = comparable(a);
    const std::vector<float> other = comparable(b);
    double sum = 0;
    for (std::size_t k = 0; k < one.size(); ++k) {
      sum += std::abs(one[k] - other[k]);
    }
    return sum / kWedgeFeatures.size();
  };
  std::vector<Wedge> whole = hand(1.2, 0.5, 12, 4);
  for (Wedge& wedge : whole) {
    wedge.depth_mm = 0.5;
    wedge.edge_slopes_rad[0] = 0.24;  // as its exit, 2 mm away, says
  }
  EXPECT_LT(mean_distance(broken(0.24, 1), whole), 0.5) << "one hand";
  EXPECT_GT(mean_distance(broken(0.12, 1), broken(0.24, 2)), 0.3) << "twice as long";
}

TEST(WedgeProfile, ToBeReadHasAnglesOfWedgesThatAreWholeAndSharp) {
  std::vector<Wedge> wedges = hand(1.2, 0.5, 12, 1);
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    wedges[i].opening_angles_rad.fill(rad_from_deg(90));
  }
  wedges[0].intact = 0.79;
  wedges[1].roundness = 0.021;
  wedges[2].roundness = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < 3; ++i) {
    wedges[i].opening_angles_rad.fill(rad_from_deg(150));
  }
  wedges[3].intact = kLeastIntact;
  wedges[3].roundness = kMostRoundness;
  const std::vector<WedgeProfile> profiles = make_read_profiles(wedges);
  ASSERT_EQ(profiles.size(), 2U);
  for (const WedgeProfile& profile : profiles) {
    EXPECT_EQ(profile.count, 12);
    for (std::size_t f = 0; f < kWedgeFeatures.size(); ++f) {
      EXPECT_EQ(profile.known[f], f < kWedgeLengths ? 12 : 9) << kWedgeFeatures[f];
    }
    EXPECT_NEAR(profile.quantiles[5][8], 90, 1e-9);
  }
  EXPECT_GT(make_profiles(wedges).front().quantiles[5][8], 90) << "wedges.json has all";
  EXPECT_EQ(make_profiles(wedges).front().known[5], 12);
}

}  // namespace
}  // namespace dubsar
