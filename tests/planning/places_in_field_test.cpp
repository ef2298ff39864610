// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Tablets that are larger than the scanner's field.
#include "planning/places_in_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <set>

#include "core/units.h"
#include "planning/sparse_flags.h"
#include "planning/tablet_on_stage.h"
#include "planning/view_candidates.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

/// A block with its middle somewhere, its faces along the axes of the model.
ModelSurface block(const Eigen::Vector3d& size_mm) {
  ModelSurface surface{MeshQuery(Mesh{}), Mesh{}, 0, {3, -2, 5}, {}, {}, {}, {}};
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner((k & 1) != 0 ? 0.5 : -0.5, (k & 2) != 0 ? 0.5 : -0.5,
                                 (k & 4) != 0 ? 0.5 : -0.5);
    surface.corners_mm.emplace_back(surface.center_mm + corner.cwiseProduct(size_mm));
  }
  return surface;
}

Rig rig_of_field(double field_mm) {
  Rig rig;
  rig.field_x_mm = field_mm;
  rig.field_y_mm = field_mm + 20;
  rig.depth_range_mm = field_mm;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(70);
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.camera_mm = Eigen::Vector3d(0, 110, 250);
  return rig;
}

/// A scan of a bit of the middle, looked at from above.
struct MiddleScan {
  RangeGrid grid;
  SampleFlags flags;
  PlacedScan placed;
  explicit MiddleScan(const Eigen::Vector3d& focus_mm) {
    grid.allocate(3, 3);
    grid.spacing_mm = 1;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const std::size_t i = grid.index(r, c);
        grid.x[i] = static_cast<float>(c - 1);
        grid.y[i] = static_cast<float>(r - 1);
        grid.valid[i] = 1;
      }
    }
    flags = flag_sparse(grid);
    placed = {0, &grid, &flags, RigidTransform{Eigen::Matrix3d::Identity(), focus_mm}, 0};
  }
};

TEST(PlacesInField, WhatFitsIsLaidOnItsMiddleAndNothingIsSaid) {
  const ModelSurface surface = block({60, 50, 22});
  EXPECT_TRUE(places_in_field(rig_of_field(70), Eigen::Matrix3d::Identity(), surface).empty());
  const MiddleScan scan(surface.center_mm);
  const std::vector<ViewCandidate> candidates = rig_candidates(rig_of_field(70), {}, scan.placed, surface);
  ASSERT_FALSE(candidates.empty());
  for (const ViewCandidate& candidate : candidates) {
    EXPECT_THAT(candidate.say, testing::Not(HasSubstr("under the scanner")));
    EXPECT_TRUE(!candidate.by_hand || candidate.placement->hand_turn->translation_mm.isZero());
  }
}

TEST(PlacesInField, AllOfALargerTabletComesIntoTheField) {
  const ModelSurface surface = block({150, 100, 30});
  const auto places = places_in_field(rig_of_field(70), Eigen::Matrix3d::Identity(), surface);
  ASSERT_GT(places.size(), 4U);
  EXPECT_TRUE(places.front().offset_mm.isZero());
  EXPECT_EQ(places.front().say, "lay its middle under the scanner");
  for (double x = -75; x <= 75; x += 5) {
    for (double y = -50; y <= 50; y += 5) {
      const bool there = std::ranges::any_of(places, [&](const PlaceInField& place) {
        return std::abs(place.offset_mm.x() - x) <= 0.4 * 70 && std::abs(place.offset_mm.y() - y) <= 0.4 * 70;
      });
      EXPECT_TRUE(there) << x << ", " << y;
    }
  }
  for (const PlaceInField& place : places) {
    EXPECT_EQ(place.offset_mm.z(), 0) << "along the support";
  }
}

TEST(PlacesInField, TheyAreNamedByTheEdgesThatTheyLieTowards) {
  const ModelSurface long_one = block({100, 20, 15});
  const auto of = [&](const ModelSurface& surface, const Eigen::Matrix3d& stage_from_model) {
    std::vector<std::string> said;
    for (const PlaceInField& place : places_in_field(rig_of_field(70), stage_from_model, surface)) {
      said.push_back(place.say);
    }
    return said;
  };
  const std::vector<std::string> of_long = of(long_one, Eigen::Matrix3d::Identity());
  EXPECT_EQ(of_long, (std::vector<std::string>{
                         "lay its middle under the scanner",
                         "lay the place 26 mm from its middle towards the left edge under the scanner",
                         "lay the place 26 mm from its middle towards the right edge under the scanner"}));
  // On its left edge it stands upright: nobody can push it up or down.
  const Eigen::Matrix3d upright = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(of(long_one, upright).empty());
  EXPECT_THAT(of(block({100, 90, 15}), Eigen::Matrix3d::Identity()),
              testing::Contains("lay the place 26 mm from its middle towards the right edge, 21 mm from its "
                                "middle towards the top edge under the scanner"));
}

TEST(PlacesInField, WhoeverLaysItAsAskedHasThePlaceUnderTheScanner) {
  const ModelSurface surface = block({100, 80, 30});
  const MiddleScan scan(surface.center_mm + Eigen::Vector3d(25.5, 15.5, 0));  // it lies on a corner
  Rig rig = rig_of_field(70);
  rig.depth_range_mm = 120;  // on whatever side it lies
  std::set<std::string> pushed;
  int turned = 0;
  for (const ViewCandidate& candidate : rig_candidates(rig, {}, scan.placed, surface)) {
    if (!candidate.by_hand) {
      EXPECT_EQ(candidate.model_from_scanner.translation_mm, scan.placed.model_from_scanner.translation_mm);
      continue;
    }
    const RigidTransform& turn = *candidate.placement->hand_turn;
    EXPECT_EQ(turn.translation_mm.z(), 0);
    const TabletOnStage lies = TabletOnStage::of({}, scan.placed).turned(turn, surface.center_mm);
    EXPECT_LT((lies.focus_mm - candidate.model_from_scanner.translation_mm).norm(), 1e-9) << candidate.say;
    // Its middle then lies where the turn says.
    const RigidTransform stage = lies.pose(rig, surface.corners_mm);
    EXPECT_LT(((stage * surface.center_mm) - turn.translation_mm).head<2>().norm(), 1e-9);
    if (turn.rotation.isIdentity()) {
      pushed.insert(candidate.say.substr(0, candidate.say.find(';')));
    } else {
      ++turned;
    }
  }
  EXPECT_GT(turned, 100);
  EXPECT_TRUE(pushed.contains("lay its middle under the scanner"));
  EXPECT_EQ(pushed.size(), 6U) << "the middle, and all of the other places but the one that it lies on";
  for (const std::string& said : pushed) {
    EXPECT_NE(said,
              "lay the place 26 mm from its middle towards the right edge, 16 mm from its middle towards the "
              "top edge under the scanner")
        << "it lies there";
  }
}

TEST(PlacesInField, WhatIsInDepthIsNotRaised) {
  EXPECT_TRUE(heights_in_field(rig_of_field(70), Eigen::Matrix3d::Identity(), block({150, 100, 60})).empty());
}

TEST(PlacesInField, AllOfATallerTabletComesIntoDepth) {
  const ModelSurface surface = block({50, 40, 20});
  Rig rig = rig_of_field(70);
  rig.depth_range_mm = 20;
  // On its left edge.
  const Eigen::Matrix3d upright = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const auto heights = heights_in_field(rig, upright, surface);
  ASSERT_EQ(heights.size(), 3U);
  EXPECT_EQ(heights.front().above_mm, 0);
  EXPECT_EQ(heights.front().say, "bring its middle to the working distance");
  EXPECT_EQ(heights.back().say, "bring the place 18 mm above its middle to the working distance");
  for (double z = 0; z <= 25; z += 1) {
    EXPECT_TRUE(std::ranges::any_of(heights, [&](const HeightInField& height) {
      return std::abs(height.above_mm - z) <= 0.4 * rig.depth_range_mm;
    })) << z;
  }
}

TEST(PlacesInField, WhoeverRaisesItAsAskedHasThePlaceInDepth) {
  const ModelSurface surface = block({50, 40, 20});
  const MiddleScan scan(surface.center_mm);
  Rig rig = rig_of_field(70);
  rig.depth_range_mm = 20;
  rig.has_turntable = false;
  rig.tilt_max_rad = 0;
  int raised = 0;
  std::array<bool, 6> end_in_depth{};
  for (const ViewCandidate& candidate : rig_candidates(rig, {}, scan.placed, surface)) {
    const Eigen::Vector3d up = candidate.model_from_scanner.rotation.col(2);
    for (std::size_t k = 0; k < end_in_depth.size(); ++k) {
      const Eigen::Vector3d out =
          (k % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k / 2));
      const double half_mm = (Eigen::Vector3d(25, 20, 10).cwiseProduct(out)).norm();
      const Eigen::Vector3d end = surface.center_mm + half_mm * out;
      const double z = up.dot(end - candidate.model_from_scanner.translation_mm);
      end_in_depth[k] = end_in_depth[k] || (up.dot(out) > 0.99 && std::abs(z) < 0.5 * rig.depth_range_mm);
    }
    if (!candidate.by_hand) {
      continue;
    }
    const RigidTransform& turn = *candidate.placement->hand_turn;
    EXPECT_LE(turn.translation_mm.z(), 0);
    raised += turn.translation_mm.z() < 0 ? 1 : 0;
    const TabletOnStage lies = TabletOnStage::of({}, scan.placed).turned(turn, surface.center_mm);
    EXPECT_LT((lies.focus_mm - candidate.model_from_scanner.translation_mm).norm(), 1e-9) << candidate.say;
  }
  EXPECT_GT(raised, 0);
  EXPECT_THAT(end_in_depth, testing::Each(true)) << "of each side, laid upwards";
}

TEST(PlacesInField, AnArmLooksThereWithoutAHand) {
  const ModelSurface surface = block({100, 40, 30});
  Rig rig = rig_of_field(70);
  rig.has_turntable = false;
  rig.hand_turns = false;
  rig.robot = RobotReach{{0, -600, 0}, {150, 1000}, {0, 600}, {150, 500}};
  const MiddleScan scan(surface.center_mm);
  Placement now;
  now.free_pose = stage_from_scanner(0, 0, {0, 0, 15});
  std::set<int> looked_at_mm;
  for (const ViewCandidate& candidate : rig_candidates(rig, {0, now}, scan.placed, surface)) {
    EXPECT_FALSE(candidate.by_hand);
    looked_at_mm.insert(
        static_cast<int>(std::lround((candidate.model_from_scanner.translation_mm - surface.center_mm).x())));
  }
  EXPECT_EQ(looked_at_mm, (std::set<int>{-26, 0, 26}));
}

}  // namespace
}  // namespace dubsar
