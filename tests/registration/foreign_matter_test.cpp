// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Fingers that hold the tablet by its edge, at another place in each scan, told from clay by what the other
// scans see; and clay, with holes and breaks, never taken for fingers.

#include "registration/foreign_matter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "core/mesh_query.h"
#include "core/units.h"
#include "planning/sparse_flags.h"
#include "sim/disturbance.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "sim/tablet.h"
#include "tests/support/other_forms.h"

namespace dubsar {
namespace {

constexpr int kViews = 12;
constexpr float kClayMm = 0.25F;  ///< samples farther from the true surface are not of it

struct Scenes {
  double spacing_mm = 0.3;
  std::uint64_t seed = 1;
  double damage = 0.3;
  double holes = 0;
  std::function<bool(int)> gripped = [](int) { return false; };
  std::function<int(int)> turn = [](int view) { return view; };
  std::function<bool(int)> taken = [](int) { return true; };
};

/// Scans of a simulated tablet where they truly lie.
class TrueScans {
 public:
  explicit TrueScans(const Scenes& scenes) {
    JobContext job;
    sim::TabletOptions options;
    options.seed = scenes.seed;
    options.size_mm = {40, 32, 14};
    options.spacing_mm = scenes.spacing_mm;
    const double d = scenes.damage;
    options.damage = {d, d, d, d, scenes.holes};
    const Result<sim::SimTablet> tablet = sim::make_tablet(options, job);
    EXPECT_TRUE(tablet);
    const std::size_t tablet_faces = tablet->mesh.faces.size();
    query_ = std::make_unique<MeshQuery>(tablet->mesh);
    const sim::TriangulationScanner scanner(sim::scanner_for(options.size_mm, scenes.spacing_mm, 0.02));
    const auto views = sim::plan_views(kViews, scenes.seed);
    for (int k = 0; k < kViews; ++k) {
      if (!scenes.taken(k)) {
        continue;
      }
      const RigidTransform& there = views[static_cast<std::size_t>(k)].tablet_from_scanner;
      const sim::SimTablet held =
          scenes.gripped(k) ? sim::disturbed(*tablet, there, sim::Disturbance::kGrip, scenes.turn(k))
                            : *tablet;
      const MeshQuery query(held.mesh);
      const sim::Scene scene{&held, &query, {}, std::nullopt};
      Result<RangeGrid> grid = scanner.scan_grid(scene, there, static_cast<std::uint64_t>(k), job);
      EXPECT_TRUE(grid);
      if (scenes.gripped(k)) {
        Mesh fingers;
        fingers.positions = held.mesh.positions;
        fingers.faces.assign(held.mesh.faces.begin() + static_cast<std::ptrdiff_t>(tablet_faces),
                             held.mesh.faces.end());
        fingers_[k] = std::make_unique<MeshQuery>(fingers);
      }
      ScanPose pose;
      pose.id = k;
      pose.status = PoseStatus::kRegistered;
      pose.model_from_scanner = there;
      poses.push_back(pose);
      matter.add(k, *grid, flag_sparse(*grid));
      grids.emplace(k, std::move(*grid));
    }
  }

  struct Count {
    std::size_t clay = 0, clay_foreign = 0, clay_doubtful = 0, hand = 0, hand_foreign = 0, hand_doubtful = 0;
    /// Of the hands, found …
    [[nodiscard]] double found() const {
      return static_cast<double>(hand_foreign) / static_cast<double>(hand);
    }
    /// … or doubted at least.
    [[nodiscard]] double told() const {
      return static_cast<double>(hand_foreign + hand_doubtful) / static_cast<double>(hand);
    }
  };
  /// Of all scans, after find().
  [[nodiscard]] Count count() const {
    Count out;
    for (const ScanPose& pose : poses) {
      const RangeGrid& grid = grids.at(pose.id);
      const std::vector<Matter> what = matter.matter(pose.id, grid);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        if (grid.valid[i] == 0) {
          continue;
        }
        const Eigen::Vector3f p = (pose.model_from_scanner * grid.point(i).cast<double>()).cast<float>();
        const bool is_clay = query_->closest(p, kClayMm).has_value();
        if (is_clay && fingers_.contains(pose.id) && fingers_.at(pose.id)->closest(p, kClayMm)) {
          continue;  // where they touch
        }
        const Matter m = what.empty() ? Matter::kTablet : what[i];
        (is_clay ? out.clay : out.hand) += 1;
        out.clay_foreign += is_clay && m == Matter::kForeign ? 1 : 0;
        out.clay_doubtful += is_clay && m == Matter::kDoubtful ? 1 : 0;
        out.hand_doubtful += !is_clay && m == Matter::kDoubtful ? 1 : 0;
        out.hand_foreign += !is_clay && m == Matter::kForeign ? 1 : 0;
      }
    }
    return out;
  }
  /// The same scan once more, where it is.
  void copy(int id, int copy_id, bool otherwise_written = false) {
    const RangeGrid& same = grids.at(id);
    const RangeGrid grid = otherwise_written ? test::rounded(test::transposed(same), 0.001) : same;
    ScanPose pose = *std::ranges::find(poses, id, &ScanPose::id);
    pose.id = copy_id;
    poses.push_back(pose);
    matter.add(copy_id, grid, flag_sparse(grid));
  }

  std::vector<ScanPose> poses;
  std::map<int, RangeGrid> grids;
  ForeignMatter matter;

 private:
  std::unique_ptr<MeshQuery> query_;
  std::map<int, std::unique_ptr<MeshQuery>> fingers_;
};

TEST(ForeignMatter, ClayIsNeverForeign) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    Scenes scenes;
    scenes.seed = seed;
    scenes.damage = 1.0;
    scenes.holes = 1.0;
    TrueScans scans(scenes);
    EXPECT_TRUE(scans.matter.find(scans.poses).empty()) << seed;
    EXPECT_GT(scans.count().clay, 30000U);
  }
}

TEST(ForeignMatter, WrongPosesMakeNoClayForeign) {
  Scenes scenes;
  scenes.damage = 1.0;
  scenes.holes = 1.0;
  TrueScans scans(scenes);
  const std::vector<ScanPose> right = scans.poses;
  for (const auto& [off_mm, off_deg, only] :
       std::vector<std::tuple<double, double, int>>{{0.3, 0.3, -1}, {1, 1, -1}, {3, 0, 5}, {2, 5, 5}}) {
    scans.poses = right;
    for (ScanPose& pose : scans.poses) {
      if (only >= 0 && pose.id != only) {
        continue;
      }
      const Eigen::Vector3d way = Eigen::Vector3d(std::sin(pose.id), std::cos(2 * pose.id), 0.5).normalized();
      pose.model_from_scanner.rotation =
          Eigen::AngleAxisd(rad_from_deg(off_deg), way.unitOrthogonal()) * pose.model_from_scanner.rotation;
      pose.model_from_scanner.translation_mm += off_mm * way;
    }
    scans.matter.find(scans.poses);
    EXPECT_EQ(scans.count().clay_foreign, 0U) << off_mm << " mm, " << off_deg << " degrees";
  }
}

TEST(ForeignMatter, FingersInSeveralScansAreFound) {
  for (const int every : {3, 2}) {
    Scenes scenes;
    scenes.gripped = [every](int view) { return view % every == 1; };
    TrueScans scans(scenes);
    const auto found = scans.matter.find(scans.poses);
    EXPECT_EQ(found.size(), static_cast<std::size_t>(kViews / every));
    for (const ForeignFound& one : found) {
      EXPECT_EQ(one.id % every, 1);
      EXPECT_FALSE(one.witnesses.empty());
      EXPECT_EQ(std::ranges::find(one.witnesses, one.id), one.witnesses.end());
    }
    const TrueScans::Count count = scans.count();
    EXPECT_EQ(count.clay_foreign, 0U) << every;
    EXPECT_GT(count.hand, 5000U);
    EXPECT_GT(count.found(), 0.9) << every;
    EXPECT_GT(count.told(), 0.98) << every;
  }
}

TEST(ForeignMatter, FingersInEveryScanAreFound) {
  Scenes scenes;
  scenes.gripped = [](int) { return true; };
  TrueScans scans(scenes);
  scans.matter.find(scans.poses);
  const TrueScans::Count count = scans.count();
  EXPECT_EQ(count.clay_foreign, 0U);
  EXPECT_GT(count.found(), 0.75);
}

TEST(ForeignMatter, TwoHandsInOnePlaceDoNotVouchForEachOther) {
  Scenes scenes;
  scenes.gripped = [](int view) { return view == 2 || view == 4; };
  scenes.turn = [](int) { return 0; };
  TrueScans scans(scenes);
  scans.matter.find(scans.poses);
  const TrueScans::Count count = scans.count();
  EXPECT_EQ(count.clay_foreign, 0U);
  EXPECT_GT(count.told(), 0.6) << "what was looked through";
}

/// The hand holds the tablet and is turned with it, three scans long; then it takes hold elsewhere.
TEST(ForeignMatter, AHandThatIsTurnedWithTheTabletIsFound) {
  Scenes scenes;
  scenes.gripped = [](int) { return true; };
  scenes.turn = [](int view) { return view / 3; };
  TrueScans scans(scenes);
  scans.matter.find(scans.poses);
  const TrueScans::Count count = scans.count();
  EXPECT_EQ(count.clay_foreign, 0U);
  EXPECT_GT(count.found(), 0.5);
  EXPECT_GT(count.told(), 0.8);
}

/// Nobody else has scanned the face that the thumb lies on: its clay stays, to be scanned once more.
TEST(ForeignMatter, WhatOnlyThisScanShowsBesideAFingerIsDoubtful) {
  Scenes all;
  const auto views = sim::plan_views(kViews, all.seed);
  Scenes scenes;
  scenes.gripped = [](int view) { return view == 0; };
  scenes.taken = [&](int view) {
    const auto looks = [&](int k) {
      return views[static_cast<std::size_t>(k)].tablet_from_scanner.rotation.col(2);
    };
    return view == 0 || looks(view).dot(looks(0)) < 0.25;
  };
  TrueScans scans(scenes);
  const auto found = scans.matter.find(scans.poses);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().id, 0);
  EXPECT_GT(found.front().doubtful_mm2, 20);
  const TrueScans::Count count = scans.count();
  EXPECT_EQ(count.clay_foreign, 0U);
  EXPECT_GT(count.clay_doubtful, 200U);
}

TEST(ForeignMatter, OnlyRegisteredScansAreWitnesses) {
  Scenes scenes;
  scenes.gripped = [](int view) { return view == 1; };
  TrueScans scans(scenes);
  ASSERT_EQ(scans.matter.find(scans.poses).size(), 1U);
  auto poses = scans.poses;
  for (ScanPose& pose : poses) {
    pose.status = pose.id == 1 ? PoseStatus::kRegistered : PoseStatus::kUnsure;
  }
  EXPECT_TRUE(scans.matter.find(poses).empty());
  EXPECT_TRUE(scans.matter.matter(1, scans.grids.at(1)).empty());
  poses = scans.poses;
  std::ranges::find(poses, 1, &ScanPose::id)->status = PoseStatus::kFailed;
  EXPECT_TRUE(scans.matter.find(poses).empty());
}

/// It would vouch for the hand that it shows as well, or look through another's as a second one.
TEST(ForeignMatter, ACopyIsNoSecondWitness) {
  Scenes scenes;
  scenes.gripped = [](int view) { return view % 2 == 1; };
  TrueScans scans(scenes);
  const std::vector<ForeignFound> once = scans.matter.find(scans.poses);
  EXPECT_TRUE(scans.matter.copies().empty());
  ASSERT_EQ(once.size(), static_cast<std::size_t>(kViews / 2));
  for (const int every : {1, 3}) {
    for (int id = 0; id < kViews; id += every) {
      scans.copy(id, 100 * every + id);
    }
  }
  const std::vector<ForeignFound> twice = scans.matter.find(scans.poses);
  ASSERT_EQ(scans.matter.copies().size(), static_cast<std::size_t>(kViews + kViews / 3));
  EXPECT_EQ(scans.matter.copies().front(), (ScanCopy{100, 0}));
  ASSERT_EQ(twice.size(), once.size());
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(twice[k].id, once[k].id);
    EXPECT_EQ(twice[k].foreign_mm2, once[k].foreign_mm2) << once[k].id;
    EXPECT_EQ(twice[k].doubtful_mm2, once[k].doubtful_mm2) << once[k].id;
    EXPECT_EQ(twice[k].witnesses, once[k].witnesses) << once[k].id;
  }
  // One counts as soon as the first of them is taken out.
  std::erase_if(scans.poses, [](const ScanPose& pose) { return pose.id == 1; });
  EXPECT_EQ(scans.matter.find(scans.poses).back().id, 101);
}

TEST(ForeignMatter, NorIsACopyInAnotherForm) {
  Scenes scenes;
  scenes.gripped = [](int view) { return view == 1; };
  TrueScans scans(scenes);
  const std::vector<ForeignFound> once = scans.matter.find(scans.poses);
  scans.copy(1, 101, true);  // as many would show the hand as look through it
  scans.copy(2, 102, true);
  const std::vector<ForeignFound> twice = scans.matter.find(scans.poses);
  EXPECT_EQ(scans.matter.copies(), (std::vector<ScanCopy>{{101, 1}, {102, 2}}));
  ASSERT_EQ(once.size(), 1U);
  ASSERT_EQ(twice.size(), 1U);
  EXPECT_EQ(twice[0].foreign_mm2, once[0].foreign_mm2);
  EXPECT_EQ(twice[0].doubtful_mm2, once[0].doubtful_mm2);
  EXPECT_EQ(twice[0].witnesses, once[0].witnesses);
}

TEST(ForeignMatter, LargeGridsAreJudgedByFewerSamples) {
  Scenes scenes;
  scenes.spacing_mm = 0.06;
  scenes.gripped = [](int view) { return view == 1; };
  scenes.taken = [](int view) { return view % 2 == 1 && view < 8; };
  TrueScans scans(scenes);
  ASSERT_GT(scans.grids.at(1).size(), 200000U);
  ASSERT_EQ(scans.matter.find(scans.poses).size(), 1U);
  const TrueScans::Count count = scans.count();
  EXPECT_EQ(count.clay_foreign, 0U);
  EXPECT_GT(count.told(), 0.9) << count.found();
}

}  // namespace
}  // namespace dubsar
