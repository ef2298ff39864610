// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/groups_apart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/scan_list.h"
#include "planning/joining_edge.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// The obverse of a plate of 44 x 30 mm, seen from straight above. On one margin knobs stand in the way of
/// whoever goes along the edge; along the one opposite runs a moulding, three times as high.
RangeGrid plate(Face rough) {
  RangeGrid grid;
  grid.allocate(120, 176);
  grid.spacing_mm = test::kSpacingMm;
  grid.view = test::turntable_rig().view;
  Random noise(3);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.cols; ++c) {
      const double x = (c - 87.5) * test::kSpacingMm;
      const double y = (r - 59.5) * test::kSpacingMm;
      const bool is_x = rough == Face::kLeft || rough == Face::kRight;
      const double way = rough == Face::kRight || rough == Face::kTop ? 1 : -1;
      const double inward = is_x ? 22 - way * x : 15 - way * y;
      const double knobs = inward < 4 ? 0.1 * std::sin(2.0 * (is_x ? y : x)) : 0.0;
      const double opposite = (is_x ? 44.0 : 30.0) - inward;
      const double moulding = opposite < 4 ? 0.3 * std::cos(1.5 * opposite) : 0.0;
      const std::size_t i = grid.index(r, c);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(knobs + moulding + 0.01 * noise.normal());
      grid.valid[i] = 1;
    }
  }
  return grid;
}

/// Scans of the plate, each in the frame of a scanner that lies so to it.
struct Plates {
  std::vector<RangeGrid> grids;
  std::vector<SampleFlags> flags;
  std::vector<PlacedScan> placed;

  Plates(Face rough, const std::vector<RigidTransform>& model_from_scanner) {
    for (const RigidTransform& pose : model_from_scanner) {
      RangeGrid grid = plate(rough);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const Eigen::Vector3d p = pose.inverse() * grid.point(i).cast<double>();
        grid.x[i] = static_cast<float>(p.x());
        grid.y[i] = static_cast<float>(p.y());
        grid.z[i] = static_cast<float>(p.z());
      }
      grids.push_back(std::move(grid));
      flags.emplace_back(grids.back().size(), 0);
    }
    for (std::size_t k = 0; k < grids.size(); ++k) {
      placed.push_back({static_cast<int>(k), &grids[k], &flags[k], model_from_scanner[k], 0.0});
    }
  }
};

/// Scans 0 … count-1 are registered, those of the other side are not.
std::vector<ScanPose> poses_of(int count, const std::vector<int>& others) {
  std::vector<ScanPose> poses;
  for (int k = 0; k < count; ++k) {
    ScanPose& pose = poses.emplace_back();
    pose.id = k;
    pose.status = PoseStatus::kRegistered;
  }
  for (const int id : others) {
    ScanPose& pose = poses.emplace_back();
    pose.id = id;
    pose.status = PoseStatus::kUnsure;
    pose.group_apart = others.front();
  }
  return poses;
}

TEST(GroupsApart, TheEdgeWithMostReliefAlongItJoins) {
  for (const Face rough : {Face::kLeft, Face::kRight, Face::kTop, Face::kBottom}) {
    const Plates plates(rough, {RigidTransform{}});
    const auto edge = joining_edge(plates.placed);
    ASSERT_TRUE(edge) << to_string(rough);
    EXPECT_EQ(edge->face, rough);
    EXPECT_GT(edge->seen.z(), 0.99);
  }
}

TEST(GroupsApart, AreToldWithTheWayOverThatEdge) {
  // The second scan was taken with the right edge 20 degrees nearer to the camera.
  const Plates plates(Face::kRight, {RigidTransform{}, test::turned(0, 20)});
  const std::vector<GroupApart> apart = groups_apart(poses_of(2, {2, 3, 4, 6}), plates.placed);
  ASSERT_THAT(apart, SizeIs(1));
  EXPECT_THAT(apart.front().ids, ElementsAre(2, 3, 4, 6));
  EXPECT_EQ(
      apart.front().say,
      "scans 2 to 4 and 6 fit one another, and not scans 0 and 1; to join them lay the tablet as for "
      "scan 1, turn the right edge towards the camera, 25°, scan, and scan twice more, each time turned "
      "on by 45° over that edge; or scan both sides again with the same pins standing, or click three "
      "places that a scan of each shows; take out what is of another tablet");
}

TEST(GroupsApart, SeveralAreToldEachBySelf) {
  const Plates plates(Face::kTop, {RigidTransform{}});
  std::vector<ScanPose> poses = poses_of(1, {5, 6});
  for (const int id : {2, 4}) {
    poses.push_back(poses.back());
    poses.back().id = id;
    poses.back().group_apart = 2;
  }
  const std::vector<GroupApart> apart = groups_apart(poses, plates.placed);
  ASSERT_THAT(apart, SizeIs(2));
  EXPECT_THAT(apart[0].ids, ElementsAre(2, 4));
  EXPECT_THAT(apart[1].ids, ElementsAre(5, 6));
  EXPECT_THAT(apart[1].say, HasSubstr("scans 5 and 6 fit one another, and not scan 0; "));
}

TEST(GroupsApart, ThereIsNoneOfOneScanNorWithoutAModel) {
  const Plates plates(Face::kTop, {RigidTransform{}});
  EXPECT_THAT(groups_apart(poses_of(1, {3}), plates.placed), IsEmpty()) << "the others were taken out";
  EXPECT_THAT(groups_apart(poses_of(1, {}), plates.placed), IsEmpty());
  EXPECT_THAT(groups_apart(poses_of(0, {3, 4}), {}), IsEmpty());
}

TEST(GroupsApart, NoEdgeIsNamedWhereTheOtherSideWasSeenBeyondAllOfThem) {
  test::Session session;
  session.scan(test::turned(0, 0));
  session.scan(test::turned(180, 0));
  std::vector<PlacedScan> both = session.map.scans();
  ASSERT_THAT(both, SizeIs(2));
  EXPECT_FALSE(joining_edge(both));
  EXPECT_THAT(
      groups_apart(poses_of(2, {2, 3}), both).front().say,
      HasSubstr("; to join them scan the edge between them, held so that both sides are in view; or "));
  EXPECT_TRUE(joining_edge({both.data(), 1}));
  EXPECT_FALSE(joining_edge({}));
}

TEST(GroupsApart, ScansInARowAreListedAsOne) {
  EXPECT_EQ(listed_in_runs(std::vector{3}), "scan 3");
  EXPECT_EQ(listed_in_runs(std::vector{3, 4}), "scans 3 and 4");
  EXPECT_EQ(listed_in_runs(std::vector{0, 1, 2}), "scans 0 to 2");
  EXPECT_EQ(listed_in_runs(std::vector{0, 2, 3, 4, 5, 9, 11, 12}), "scans 0, 2 to 5, 9, 11 and 12");
}

}  // namespace
}  // namespace dubsar
