// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/planning_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "formats/red_map_json.h"
#include "planning/model_faces.h"
#include "station/results.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/other_forms.h"

namespace dubsar {
namespace {

std::vector<ScanPose> poses_with(double sigma_mm) {
  std::vector<ScanPose> poses;
  for (int k = 0; k < 3; ++k) {
    ScanPose pose;
    pose.id = k;
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = test::bumpy_pose(k);
    pose.sigma_mm = sigma_mm;
    poses.push_back(pose);
  }
  return poses;
}

/// The red map after these steps, all but the last as the online engine takes them.
std::string map_after(const std::vector<std::vector<ScanPose>>& steps) {
  PlanningStage stage;
  for (int k = 0; k < 3; ++k) {
    stage.add(prepare_scan(k, test::bumpy_scan(k), std::nullopt));
  }
  JobContext job;
  for (const auto& poses : steps) {
    EXPECT_TRUE(stage.place(poses, &poses == &steps.back(), job));
  }
  const auto map = stage.red_map(nullptr, job);
  EXPECT_TRUE(map);
  return map ? red_map_to_json(*map) : "";
}

TEST(PlanningStage, APoseThatOnlyBecameMoreCertainCountsAsItIsStored) {
  const auto rough = poses_with(0.6);
  const auto certain = poses_with(0.001);
  ASSERT_NE(map_after({rough}), map_after({certain})) << "certainty changes how far samples clear others";
  EXPECT_EQ(map_after({rough, certain}), map_after({certain}))
      << "whoever works it out from the stored poses gets the same";
}

TEST(PlanningStage, TheWayThereDoesNotMatter) {
  auto wandering = poses_with(0.01);
  wandering[1].model_from_scanner.translation_mm.x() += 0.7;
  wandering[2].status = PoseStatus::kUnsure;
  EXPECT_EQ(map_after({wandering, poses_with(0.01)}), map_after({poses_with(0.01)}));
}

// Motors must not be sent past a tablet that stands on its edge as if it lay flat as before.
TEST(PlanningStage, KnowsNotHowATabletLiesThatWasTurnedForAScanWithoutAPlace) {
  for (const int placement : {0, 1}) {
    PlanningStage stage;
    EXPECT_FALSE(stage.knows_how_it_lies());
    for (int k = 0; k < 3; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      grid.nominal.emplace().placement = k == 2 ? placement : 0;
      StationScan scan = prepare_scan(k, std::move(grid), std::nullopt);
      scan.drive = Placement{};
      stage.add(scan);
    }
    JobContext job;
    std::vector<ScanPose> poses = poses_with(0.01);
    ASSERT_TRUE(stage.place(poses, true, job));
    EXPECT_TRUE(stage.knows_how_it_lies());
    poses.pop_back();
    ASSERT_TRUE(stage.place(poses, true, job));
    EXPECT_EQ(stage.knows_how_it_lies(), placement == 0) << "or it was not turned";
  }
}

/// The tablet may have been turned for the scan that has no place, and lies as it lies there.
TEST(PlanningStage, ATurnByHandSaysFromWhichScanItGoesWhereTheNewestHasNoPlace) {
  PlanningStage stage;
  for (int k = 0; k < 3; ++k) {
    stage.add(prepare_scan(k, test::bumpy_scan(k), std::nullopt));
  }
  JobContext job;
  for (const PoseStatus newest : {PoseStatus::kRegistered, PoseStatus::kUnsure}) {
    std::vector<ScanPose> poses = poses_with(0.01);
    poses.back().status = newest;
    ASSERT_TRUE(stage.place(poses, true, job));
    const Result<RedMap> map = stage.red_map(nullptr, job);
    ASSERT_TRUE(map);
    ASSERT_FALSE(map->next.empty());
    for (const NextView& view : map->next) {
      EXPECT_EQ(view.say.find("from how it lay for scan 1: ") == 0, newest == PoseStatus::kUnsure)
          << view.say;
    }
  }
}

/// Red map, mesh and checklist see the scan once, and the copy is told.
TEST(PlanningStage, ACopyIsTheScanThatItIsOf) {
  PlanningStage stage;
  PlanningStage alone;
  for (int k = 0; k < 3; ++k) {
    const StationScan scan = prepare_scan(k, test::bumpy_scan(k), std::nullopt);
    stage.add(scan);
    alone.add(scan);
  }
  const RangeGrid written_otherwise = test::rounded(test::transposed(test::bumpy_scan(1)), 0.001);
  stage.add(prepare_scan(3, written_otherwise, std::nullopt));
  JobContext job;
  const std::vector<ScanPose> of_three = poses_with(0.01);
  std::vector<ScanPose> of_four = of_three;
  of_four.push_back(of_three[1]);
  of_four[3].id = 3;
  of_four[3].model_from_scanner.translation_mm.x() += 0.01;
  ASSERT_TRUE(alone.place(of_three, true, job));
  ASSERT_TRUE(stage.place(of_four, true, job));
  EXPECT_EQ(stage.placed().size(), 3U);
  const RedMap once = alone.red_map(nullptr, job).value();
  RedMap twice = stage.red_map(nullptr, job).value();
  EXPECT_TRUE(once.copies.empty());
  ASSERT_EQ(twice.copies, (std::vector<ScanCopy>{{3, 1}}));
  const Mesh mesh = stage.mesh(job).value();
  EXPECT_EQ(mesh.positions, alone.mesh(job).value().positions);
  const Checklist list = checklist_of(twice, of_four, stage, mesh, nullptr, nullptr, job).value();
  EXPECT_EQ(list.scans_registered, 3);
  ASSERT_EQ(list.warnings.size(), 1U);
  EXPECT_EQ(list.warnings[0].scan, 3);
  twice.copies.clear();
  EXPECT_EQ(red_map_to_json(twice), red_map_to_json(once));

  // It comes in where the first is taken out, and goes when that one comes back.
  std::vector<ScanPose> without = of_four;
  without.erase(without.begin() + 1);
  ASSERT_TRUE(stage.place(without, true, job));
  EXPECT_TRUE(stage.copies().empty());
  EXPECT_EQ(stage.placed().back().id, 3);
  ASSERT_TRUE(stage.place(of_four, true, job));
  EXPECT_EQ(stage.placed().back().id, 2);
}

TEST(PlanningStage, AScanThatIsWhollyInTheWayIsNoPartOfRedMapAndMesh) {
  PlanningStage stage;
  std::vector<ScanPose> poses;
  for (int k = 0; k < 4; ++k) {
    stage.add(prepare_scan(k, test::bumpy_scan(k), std::nullopt));
    poses.push_back({});
    poses.back().id = k;
    poses.back().status = PoseStatus::kRegistered;
    poses.back().model_from_scanner = test::bumpy_pose(k);
  }
  JobContext job;
  ASSERT_TRUE(stage.place(poses, true, job));
  EXPECT_EQ(stage.placed().size(), 4U);
  poses[0].model_from_scanner.translation_mm.z() += 10;  // as if something were held over the tablet
  ASSERT_TRUE(stage.place(poses, true, job));
  ASSERT_EQ(stage.foreign().size(), 1U);
  ASSERT_TRUE(stage.foreign().front().is_all());
  ASSERT_EQ(stage.placed().size(), 3U);
  EXPECT_EQ(stage.placed().front().id, 1);
}

TEST(PlanningStage, TellsOfPosesThatDoNotFitAndLeavesALockedScanWhereItIs) {
  PlanningStage stage;
  std::vector<ScanPose> poses = poses_with(0.01);
  std::map<int, std::string> names{{7, "not placed"}};
  for (int k = 0; k < 3; ++k) {
    stage.add(prepare_scan(k, test::bumpy_scan(k), std::nullopt));
    names[k] = test::scan_name(k);
  }
  JobContext job;
  ASSERT_TRUE(stage.place(poses, true, job));
  ASSERT_TRUE(stage.mesh(job));
  EXPECT_TRUE(stage.warnings_of_mesh(names).empty());
  const auto height_mm = [&](const std::vector<ScanPose>& of) {
    EXPECT_TRUE(stage.place(of, true, job));
    const Mesh mesh = stage.mesh(job).value();
    double sum_mm = 0;
    for (const Eigen::Vector3f& p : mesh.positions) {
      sum_mm += static_cast<double>(p.z());
    }
    return sum_mm / static_cast<double>(mesh.positions.size());
  };
  const double true_mm = height_mm(poses);
  constexpr double kOffMm = 0.5;
  poses[0].model_from_scanner.translation_mm.z() += kOffMm;
  EXPECT_NEAR(height_mm(poses), true_mm, 0.1) << "one is laid where two have it";
  EXPECT_FALSE(stage.warnings_of_mesh(names).empty());
  poses[0].locked = true;
  EXPECT_NEAR(height_mm(poses), true_mm + kOffMm, 0.1) << "two are laid where the locked one is";
}

/// Scans 0 and 1 lie as they were put down. Those after them, of the tablet on other sides, are not taken up.
TEST(PlanningStage, AfterMissesTheTabletIsLaidOtherwiseAndLookedAtFromElsewhere) {
  Rig rig;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(70);
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.camera_mm = Eigen::Vector3d(0, 110, 250);
  PlanningStage stage;
  std::vector<ScanPose> poses;
  const auto scanned = [&](int id, const RigidTransform& from, const Placement& drive, PoseStatus status) {
    RangeGrid grid = test::bumpy_scan(id);
    grid.nominal.emplace().tablet_from_scanner = from;
    StationScan scan = prepare_scan(id, std::move(grid), std::nullopt);
    scan.drive = drive;
    stage.add(scan);
    poses.push_back({});
    poses.back().id = id;
    poses.back().status = status;
    poses.back().model_from_scanner = from;
  };
  scanned(0, test::bumpy_pose(0), {}, PoseStatus::kRegistered);
  scanned(1, test::bumpy_pose(1), {}, PoseStatus::kRegistered);
  JobContext job;
  ASSERT_TRUE(stage.place(poses, false, job));
  const RedMap map = stage.red_map(&rig, job).value();
  std::vector<int> in_vain;
  NextView asked = *std::ranges::find_if(
      map.next, [](const NextView& view) { return view.placement && view.placement->hand_turn; });
  for (int id = 2; id < 5; ++id) {
    scanned(id, asked.model_from_scanner, *asked.placement, PoseStatus::kUnsure);
    in_vain.push_back(id);
    const std::optional<NextView> next = stage.laid_otherwise(rig, in_vain, job);
    ASSERT_TRUE(next);
    EXPECT_TRUE(next->placement && next->placement->hand_turn) << next->say;
    for (const int one : in_vain) {
      const RigidTransform& from = poses[static_cast<std::size_t>(one)].model_from_scanner;
      const RigidTransform& to = next->model_from_scanner;
      const double turned_rad =
          std::acos(std::clamp(from.rotation.col(2).dot(to.rotation.col(2)), -1.0, 1.0));
      EXPECT_TRUE(turned_rad > rad_from_deg(25.0) || (from.translation_mm - to.translation_mm).norm() > 20)
          << one;
    }
    asked = *next;
  }
}

/// A side of 44 × 50 mm; where its left and right ends crowd with vertices, it is no wider for that.
TEST(PlanningStage, ThePicturesNameTheFacesAsThePlanDoes) {
  Mesh mesh;
  const auto row_at = [&](float x, int steps) {
    for (int k = 0; k <= steps; ++k) {
      const float y = -25.0F + 50.0F * static_cast<float>(k) / static_cast<float>(steps);
      mesh.positions.emplace_back(x, y, 0.0F);
      mesh.positions.emplace_back(x, y, -12.0F);
    }
  };
  for (const float x : {-22.0F, 22.0F}) {
    row_at(x, 500);
  }
  for (int x = -20; x <= 20; x += 5) {
    row_at(static_cast<float>(x), 10);
  }
  PlanningStage stage;
  stage.add(prepare_scan(0, test::bumpy_scan(0), std::nullopt));
  JobContext job;
  std::vector<ScanPose> poses = poses_with(0.01);
  poses.resize(1);
  ASSERT_TRUE(stage.place(poses, true, job));
  const Eigen::Vector3d top = model_faces(stage.placed(), mesh.positions).normal(Face::kTop);
  EXPECT_GT(std::abs(top.y()), 0.9) << "the height is the largest extent";
  EXPECT_GT((stage.tablet_from_model(mesh).rotation * top).y(), 0.9);
}

}  // namespace
}  // namespace dubsar
