// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Under which ids wedges are told, from nothing and after an earlier measurement.

#include "analysis/wedge_ids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

const Mesh& slab() {
  static const Mesh kSlab = shapes::box({50, 40, 20}, 4);
  return kSlab;
}

/// Its tail runs to the right of a side that looks along `normal`.
Wedge wedge_at(const Eigen::Vector3d& place, const Eigen::Vector3d& normal, const Eigen::Vector3d& tail) {
  Wedge wedge;
  wedge.id = 999;
  wedge.depth_point_mm = place;
  wedge.surface_normal = normal;
  wedge.exit_points_surface_mm = {place + tail, place - 0.3 * tail, place + 0.3 * normal.cross(tail)};
  wedge.confidence = 1;
  wedge.directional_margin = 1;
  return wedge;
}
Wedge on_obverse(double x, double y, int body = 0) {
  Wedge wedge = wedge_at({x, y, 9.5}, {0, 0, 1}, {1, 0, 0});
  wedge.place.body = body;
  return wedge;
}

/// What a later measurement gets to know.
EarlierWedges known(const std::vector<int>& ids, const std::vector<Wedge>& wedges,
                    const std::vector<KnownWedge>& former = {}) {
  EarlierWedges out{former, false};
  for (std::size_t k = 0; k < wedges.size(); ++k) {
    out.wedges.push_back({ids[k], wedges[k].depth_point_mm, wedges[k].by_hand});
  }
  return out;
}

/// The same ids in the wedges themselves.
std::vector<Wedge> with_ids(std::vector<Wedge> wedges, const std::vector<int>& ids) {
  for (std::size_t k = 0; k < wedges.size(); ++k) {
    wedges[k].id = ids[k];
  }
  return wedges;
}

TEST(WedgeIds, FromNothingGoAsAReaderDoes) {
  const std::vector<Wedge> wedges = {
      wedge_at({0, 0, -9.5}, {0, 0, -1}, {1, 0, 0}),   // the reverse
      on_obverse(8, 2),                                // its second line, from here
      on_obverse(-8, 12),                              // the first
      on_obverse(-8, 2),                               // before the second one
      wedge_at({0, -19.5, 0}, {0, -1, 0}, {1, 0, 0}),  // the lower edge
      on_obverse(9, 12),                               // the end of the first line
  };
  EXPECT_THAT(WedgeIds({}).of_found(slab(), wedges), ElementsAre(5, 3, 0, 2, 4, 1));
  // One tablet after the other.
  EXPECT_THAT(WedgeIds({}).of_found(slab(), {on_obverse(-8, 12, 2), on_obverse(8, -12, 1)}),
              ElementsAre(1, 0));
  EXPECT_THAT(WedgeIds({}).of_found(slab(), {}), IsEmpty());
}

TEST(WedgeIds, StayWithTheirPlacesAndAreNeverGivenToAnother) {
  const std::vector<Wedge> first = {on_obverse(-8, 12), on_obverse(0, 12), on_obverse(8, 12)};
  // The second is gone, one more stands before them all, and the last has moved a little.
  const std::vector<Wedge> second = {on_obverse(8.1, 12.1), on_obverse(-15, 12), on_obverse(-8, 12)};
  WedgeIds ids(known({0, 1, 2}, first));
  const std::vector<int> given = ids.of_found(slab(), second);
  EXPECT_THAT(given, ElementsAre(2, 3, 0));
  EXPECT_EQ(ids.found_again(), 2U);
  const std::vector<KnownWedge> former = ids.former(with_ids(second, given));
  EXPECT_THAT(former, ElementsAre(Field(&KnownWedge::id, 1)));
  // It comes back, the newest one goes, and there is one more: 3 is not given again.
  const std::vector<Wedge> third = {on_obverse(15, -12), first[1], second[0], second[2]};
  WedgeIds later(known(given, second, former));
  const std::vector<int> now = later.of_found(slab(), third);
  EXPECT_THAT(now, ElementsAre(4, 1, 2, 0));
  EXPECT_THAT(later.former(with_ids(third, now)), ElementsAre(Field(&KnownWedge::id, 3)));
}

TEST(WedgeIds, OfTwoThatLieCloseTheNearestIsTheSame) {
  WedgeIds ids(known({7, 3}, {on_obverse(0, 0), on_obverse(0.2, 0)}));
  EXPECT_THAT(ids.of_found(slab(), {on_obverse(0.21, 0), on_obverse(0.12, 0)}), ElementsAre(3, 7));
  WedgeIds far(known({7}, {on_obverse(0, 0)}));
  EXPECT_THAT(far.of_found(slab(), {on_obverse(1.01 * kSamePlaceMm, 0)}), ElementsAre(8));
}

TEST(WedgeIds, OfWhatAPersonMadeGoByHowItCameAbout) {
  const Wedge found = on_obverse(0, 0);
  Wedge merged = on_obverse(0.1, 0);
  merged.by_hand = ByHand::kMerged;
  Wedge added = on_obverse(5, 0);
  added.by_hand = ByHand::kAdded;
  const EarlierWedges earlier = known({0, 1, 2}, {found, merged, added});
  WedgeIds ids(earlier);
  EXPECT_THAT(ids.of_found(slab(), {on_obverse(0.1, 0)}), ElementsAre(0)) << "not the merged one's";
  EXPECT_EQ(ids.of_made(added), 2);
  EXPECT_EQ(ids.of_made(merged), 1);
  EXPECT_EQ(ids.found_again(), 3U) << "also those that a person made";
  EXPECT_EQ(ids.of_made(merged), 3) << "each once";
  EXPECT_EQ(ids.found_again(), 3U);
  WedgeIds better(earlier);
  EXPECT_THAT(better.of_found(slab(), {found, on_obverse(5, 0)}), ElementsAre(0, 2))
      << "a better mesh shows by itself what had to be added";
  WedgeIds worse(known({4}, {on_obverse(5, 0)}));
  EXPECT_THAT(worse.of_found(slab(), {}), IsEmpty());
  EXPECT_EQ(worse.of_made(added), 4);
}

TEST(WedgeIds, OfAnotherTabletAreForgottenWhereThePlacesSayThatItIsOne) {
  std::vector<Wedge> wedges;
  std::vector<Wedge> elsewhere;
  for (int k = 0; k < 6; ++k) {
    wedges.push_back(on_obverse(3 * k - 9, 0));
    elsewhere.push_back(on_obverse(3 * k - 9, 2 + k % 2));
  }
  EarlierWedges earlier = known({10, 11, 12, 13, 14, 15}, wedges);
  earlier.may_be_others = true;
  WedgeIds others(earlier);
  EXPECT_THAT(others.of_found(slab(), elsewhere).front(), ::testing::Lt(6));
  EXPECT_TRUE(others.forgot_earlier());
  EXPECT_THAT(others.former(with_ids(elsewhere, {0, 1, 2, 3, 4, 5})), IsEmpty());
  std::ranges::copy_n(wedges.begin(), 3, elsewhere.begin());
  WedgeIds same(earlier);
  EXPECT_THAT(same.of_found(slab(), elsewhere),
              ElementsAre(10, 11, 12, ::testing::Ge(16), ::testing::Ge(16), ::testing::Ge(16)));
  EXPECT_FALSE(same.forgot_earlier());
  // Of the very tablet, wherever it lies now, no id is another wedge's.
  earlier.may_be_others = false;
  WedgeIds moved(earlier);
  EXPECT_THAT(moved.of_found(slab(), {on_obverse(0, 10)}), ElementsAre(16));
  EXPECT_EQ(moved.former({}).size(), 7U);
}

TEST(WedgeIds, OfAFileThatSomebodyWroteAreNotTakenOnTrust) {
  const Wedge wedge = on_obverse(0, 0);
  WedgeIds ids(known({-3, 2'147'483'647, 5, 5}, {wedge, wedge, wedge, on_obverse(9, 0)}));
  EXPECT_THAT(ids.of_found(slab(), {on_obverse(9, 0), wedge}), ElementsAre(6, 5));
}

}  // namespace
}  // namespace dubsar
