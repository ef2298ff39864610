// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scanner that does not tilt: what only a tablet shows that is propped by hand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "core/units.h"
#include "planning/next_view.h"
#include "planning/sparse_flags.h"
#include "planning/tablet_on_stage.h"
#include "planning/view_candidates.h"

namespace dubsar {
namespace {

Rig still_rig() {
  Rig rig;
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.camera_mm = Eigen::Vector3d(0, 110, 250);
  return rig;
}

/// A slab of 40 x 40 x 10 mm with a trench along y, 2 mm wide and 1 mm deep: its far wall and what lies
/// beyond cast the shadows.
ModelSurface trenched_slab() {
  Mesh mesh;
  mesh.positions = {{2, -20, 0}, {2, 20, 0}, {20, -20, 0}, {20, 20, 0}, {2, -20, -1}, {2, 20, -1}};
  mesh.faces = {{0, 2, 1}, {2, 3, 1}, {4, 0, 5}, {0, 1, 5}};
  ModelSurface surface{MeshQuery(mesh), mesh, 0.1, {0, 0, -5}, {}, {}, {}, {}};
  for (int k = 0; k < 8; ++k) {
    surface.corners_mm.emplace_back((k & 1) != 0 ? 20 : -20, (k & 2) != 0 ? 20 : -20, (k & 4) != 0 ? 0 : -10);
  }
  return surface;
}

/// Seen from straight above its middle.
struct TopScan {
  RangeGrid grid;
  SampleFlags flags;
  PlacedScan placed;
  TopScan() {
    grid.allocate(3, 3);
    grid.spacing_mm = 0.1;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      grid.x[i] = 0.1F * static_cast<float>(grid.col_of(i));
      grid.y[i] = 0.1F * static_cast<float>(grid.row_of(i));
      grid.valid[i] = 1;
    }
    flags = flag_sparse(grid);
    placed = {0, &grid, &flags, RigidTransform{Eigen::Matrix3d::Identity(), {0, 0, -5}}, 0};
  }
};

/// The greatest chance of a target that any pose of the rig has.
double best_chance(const Rig& rig, const RedTarget& target) {
  const TopScan top;
  const ModelSurface surface = trenched_slab();
  const std::vector<ViewCandidate> candidates = rig_candidates(rig, {}, top.placed, surface);
  JobContext job;
  const std::vector<RedTarget> targets{target};
  return static_cast<double>(
      next_views(candidates, ScannerModel::of(rig, 0.01), surface, targets, {}, job).value().best_chance[0]);
}

RedTarget near_wall_of_trench() {
  RedTarget wall;
  wall.position_mm = wall.sample_mm = {0, 0, -0.5};
  wall.normal = {1, 0, 0};
  wall.area_mm2 = 2;
  return wall;
}

TEST(Leaning, ASteepWallIsInReachOfAHandThatPropsTheTablet) {
  EXPECT_GT(best_chance(still_rig(), near_wall_of_trench()), 0.5);
}

TEST(Leaning, NoHandPropsWhatItMayNotTurn) {
  Rig rig = still_rig();
  rig.hand_turns = false;
  EXPECT_EQ(best_chance(rig, near_wall_of_trench()), 0);
}

TEST(Leaning, NobodyPropsATabletForAScannerThatTilts) {
  const TopScan top;
  const ModelSurface surface = trenched_slab();
  Rig rig = still_rig();
  const auto leaning = [&] {
    const std::vector<ViewCandidate> all = rig_candidates(rig, {}, top.placed, surface);
    return std::ranges::count_if(all, &ViewCandidate::leans);
  };
  EXPECT_GT(leaning(), 0);
  rig.tilt_max_rad = rad_from_deg(60);
  EXPECT_EQ(leaning(), 0);
}

/// Where no motor moves, too, each view has words: a terminal shows nothing else.
TEST(Leaning, WhatStaysAsItLiesIsSaid) {
  const TopScan top;
  const std::vector<ViewCandidate> all = rig_candidates(still_rig(), {}, top.placed, trenched_slab());
  ASSERT_FALSE(all.empty());
  for (const ViewCandidate& candidate : all) {
    EXPECT_FALSE(candidate.say.empty());
    EXPECT_EQ(candidate.say == "leave the tablet as it lies", !candidate.by_hand) << candidate.say;
  }
}

/// What is turned over then stands upside down, and there is no telling which way round.
TEST(Leaning, NoTurnMirrorsATabletThatStandsOnItsBottomEdge) {
  TopScan top;
  top.placed.model_from_scanner.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // looks at the top edge
  int turned = 0;
  for (const ViewCandidate& candidate : rig_candidates(still_rig(), {}, top.placed, trenched_slab())) {
    EXPECT_TRUE(candidate.model_from_scanner.is_rigid(1e-9)) << candidate.say;
    if (candidate.by_hand) {
      EXPECT_TRUE(candidate.placement->hand_turn->is_rigid(1e-9)) << candidate.say;
      ++turned;
    }
  }
  EXPECT_GT(turned, 100);
}

TEST(Leaning, WhoProppedItAsAskedHasItSo) {
  const TopScan top;
  const ModelSurface surface = trenched_slab();
  for (const ViewCandidate& candidate : rig_candidates(still_rig(), {}, top.placed, surface)) {
    if (!candidate.leans) {
      EXPECT_EQ(candidate.say.find("propped"), std::string::npos) << candidate.say;
      continue;
    }
    EXPECT_NE(candidate.say.find(", propped up"), std::string::npos) << candidate.say;
    ASSERT_TRUE(candidate.by_hand && candidate.placement && candidate.placement->hand_turn);
    const TabletOnStage lies =
        TabletOnStage::of({}, top.placed).turned(*candidate.placement->hand_turn, surface.center_mm);
    EXPECT_LT((lies.focus_mm - candidate.model_from_scanner.translation_mm).norm(), 1e-9);
    EXPECT_TRUE(lies.stage_from_model.row(2).transpose().isApprox(
        candidate.model_from_scanner.rotation.col(2), 1e-9));
  }
}

TEST(Leaning, IsAskedForWhereNoSideShowsAsMuch) {
  const ModelSurface surface = trenched_slab();
  RedTarget flat;
  flat.position_mm = flat.sample_mm = {-5, 0, 0};
  flat.area_mm2 = 1;
  // From straight above, and from 30° beside that.
  std::vector<ViewCandidate> candidates(2);
  candidates[0].by_hand = candidates[0].leans = true;
  candidates[0].say = "leaning";
  candidates[0].model_from_scanner.rotation =
      Eigen::AngleAxisd(rad_from_deg(-30), Eigen::Vector3d::UnitY()).toRotationMatrix();
  candidates[1].by_hand = true;
  candidates[1].say = "lying";
  JobContext job;
  const auto first = [&](const RedTarget& target) {
    const std::vector<RedTarget> targets{target};
    NextViewOptions options;
    options.least_overlap = 0;
    const NextViews views =
        next_views(candidates, ScannerModel::of(still_rig(), 0.01), surface, targets, options, job).value();
    return views.ranked.empty() ? std::string() : views.ranked.front().say;
  };
  EXPECT_EQ(first(flat), "lying");
  RedTarget wall = near_wall_of_trench();
  wall.normal = Eigen::Vector3d(0.95, 0, 0.2).normalized();
  candidates[0].model_from_scanner.rotation =
      Eigen::AngleAxisd(rad_from_deg(45), Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_EQ(first(wall), "leaning");
}

}  // namespace
}  // namespace dubsar
