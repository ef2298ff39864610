// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scanner.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "core/units.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

/// A scanner without any fault but those that a test turns on.
ScannerOptions perfect() {
  ScannerOptions options;
  options.spacing_mm = 0.2;
  options.noise_mm = 0;
  options.dropout = 0;
  options.outlier = 0;
  options.mixed_pixel = 0;
  options.quantum_mm = 0;
  options.dark_signal = 0;
  return options;
}

RangeGrid scan(const ScannerOptions& options, const TestScene& scene, const RigidTransform& pose = {},
               std::uint64_t number = 0) {
  JobContext job;
  Result<RangeGrid> grid = TriangulationScanner(options).scan_grid(scene.scene, pose, number, job);
  EXPECT_TRUE(grid.has_value());
  return std::move(*grid);
}

RigidTransform tilted(double deg) {
  return {Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitX()).toRotationMatrix(), {0, 0, 0}};
}

/// Root mean square of the distances to the plane z = 0 of the tablet frame, along the laser's ray.
double ray_rms(const RangeGrid& grid, const RigidTransform& pose) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    const Eigen::Vector3d ray = -grid.view.to_laser(p, grid.row_of(i));
    const double along = (pose * p).z() / (pose.rotation * ray).z();
    sum += along * along;
    count += 1;
  }
  return std::sqrt(sum / count);
}

TEST(Scanner, WithoutFaultsReturnsTheSurface) {
  const TestScene scene(plane(15, 0, 0.6F));
  const RangeGrid grid = scan(perfect(), scene, tilted(20));
  EXPECT_GT(grid.valid_count(), 15000U);
  EXPECT_LT(ray_rms(grid, tilted(20)), 1e-4);
  EXPECT_NEAR(estimate_spacing_mm(grid), 0.2, 0.02);
}

TEST(Scanner, NoiseIsAsAskedAndGrowsWithIncidence) {
  ScannerOptions options = perfect();
  options.noise_mm = 0.02;
  const TestScene scene(plane(15, 0, 0.6F));
  const double flat = ray_rms(scan(options, scene), {});
  EXPECT_NEAR(flat, 0.02, 0.0015);
  // Tilted away from the camera by 40°, it sees the plane at about 64°.
  const double steep = ray_rms(scan(options, scene, tilted(-40)), tilted(-40));
  EXPECT_GT(steep, 1.4 * flat);
}

TEST(Scanner, SpeckleHangsTogetherAlongTheProfileOnly) {
  ScannerOptions options = perfect();
  options.noise_mm = 0.02;
  const TestScene scene(plane(15, 0, 0.6F));
  const RangeGrid grid = scan(options, scene);
  double along = 0;
  double across = 0;
  double power = 0;
  for (int r = 20; r < grid.rows - 20; ++r) {
    for (int c = 20; c < grid.cols - 20; ++c) {
      const double z = grid.z[grid.index(r, c)];
      power += z * z;
      along += z * grid.z[grid.index(r, c + 1)];
      across += z * grid.z[grid.index(r + 1, c)];
    }
  }
  EXPECT_GT(along / power, 0.3);
  EXPECT_LT(std::abs(across / power), 0.05);
}

TEST(Scanner, AStepThrowsTheCamerasShadow) {
  SimTablet step = plane(15, -5, 0.6F);
  add_block(&step, 5, 5, -5, 0, 0.6F);
  const TestScene scene(std::move(step));
  const ScannerOptions options = perfect();
  const RangeGrid grid = scan(options, scene);
  // The camera stands towards +y: beyond the block, towards -y, the ground is hidden for
  // height·base/stand-off.
  const double shadow = 5.0 * options.baseline_mm / options.standoff_mm;
  int hidden = 0;
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.cols; ++c) {
      if (!grid.is_valid(r, c)) {
        continue;
      }
      const Eigen::Vector3f p = grid.point(grid.index(r, c));
      const bool beside = std::abs(p.x()) < 4.5F && p.z() < -4.9F;
      EXPECT_FALSE(beside && p.y() < -5.05F && p.y() > -5.0F - static_cast<float>(shadow) + 0.05F);
    }
    const double y = grid.view.laser_mm->y() + r * options.spacing_mm;
    const bool in_shadow = y < -5.1 && y > -5.0 - shadow + 0.1;
    const bool lit = y < -5.0 - shadow - 0.2 && y > -14;
    const int middle = grid.cols / 2;
    if (in_shadow) {
      EXPECT_FALSE(grid.is_valid(r, middle)) << y;
      ++hidden;
    }
    if (lit) {
      EXPECT_TRUE(grid.is_valid(r, middle)) << y;
    }
  }
  EXPECT_GT(hidden, 5);
}

TEST(Scanner, TheLaserCannotReachUnderAnOverhang) {
  SimTablet shelf = plane(15, -10, 0.6F);
  add_quad(&shelf, {5, -5, 0}, {12, -5, 0}, {12, 5, 0}, {5, 5, 0}, 0.6F);
  const TestScene scene(std::move(shelf));
  const RangeGrid grid = scan(perfect(), scene);
  int floor = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && grid.z[i] < -9) {
      const Eigen::Vector3f p = grid.point(i);
      // The fan from 250 mm above takes the shelf's x limits down to 10/250 farther out.
      EXPECT_FALSE(p.x() > 5.25F && p.x() < 12.4F && std::abs(p.y()) < 4.9F);
      ++floor;
    }
  }
  // Of 900 mm² the shelf shades 74, and hides no more than as many again from the camera.
  EXPECT_GT(floor, 10000) << "of 22500 cells";
}

TEST(Scanner, DepthRangeAndGrazingAnglesLimitReturns) {
  ScannerOptions options = perfect();
  options.depth_range_mm = 10;
  const TestScene far(plane(15, -6, 0.6F));
  EXPECT_EQ(scan(options, far).valid_count(), 0U);
  const TestScene near(plane(15, -4, 0.6F));
  EXPECT_GT(scan(options, near).valid_count(), 10000U);
  const TestScene edge_on(plane(15, 0, 0.6F));
  EXPECT_EQ(scan(perfect(), edge_on, tilted(-72)).valid_count(), 0U);  // 96° for the camera
  EXPECT_GT(scan(perfect(), edge_on, tilted(60)).valid_count(), 3000U);
}

TEST(Scanner, DarkClayLosesReturnsAndIntensityFollowsAlbedo) {
  ScannerOptions options = perfect();
  options.dark_signal = 0.06;
  const TestScene bright(plane(10, 0, 0.8F));
  const TestScene dim(plane(10, 0, 0.4F));
  const TestScene dark(plane(10, 0, 0.03F));
  const RangeGrid bright_grid = scan(options, bright);
  const RangeGrid dim_grid = scan(options, dim);
  EXPECT_LT(scan(options, dark).valid_count(), bright_grid.valid_count() / 4);
  EXPECT_GT(dim_grid.valid_count(), bright_grid.valid_count() * 99 / 100);
  const std::size_t middle = bright_grid.index(bright_grid.rows / 2, bright_grid.cols / 2);
  EXPECT_GT(bright_grid.intensity[middle], 1.3F * dim_grid.intensity[middle]);
}

TEST(Scanner, MixedPixelsFallBetweenTheSidesOfAnEdge) {
  SimTablet step = plane(15, -5, 0.6F);
  add_block(&step, 5, 5, -5, 0, 0.6F);
  const TestScene scene(std::move(step));
  const auto between = [&](const ScannerOptions& options) {
    const RangeGrid grid = scan(options, scene);
    int count = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      count += grid.valid[i] != 0 && grid.z[i] > -4.5F && grid.z[i] < -0.5F ? 1 : 0;
    }
    return count;
  };
  ScannerOptions options = perfect();
  const int clean = between(options);
  options.mixed_pixel = 0.5;
  EXPECT_GT(between(options), clean + 20);
}

TEST(Scanner, OutliersDropoutsAndQuantumComeAsOftenAsAsked) {
  ScannerOptions options = perfect();
  options.outlier = 0.01;
  options.dropout = 0.02;
  options.quantum_mm = 0.25;
  const TestScene scene(plane(15, 0.1F, 0.6F));
  const RangeGrid whole = scan(perfect(), scene);
  const RangeGrid grid = scan(options, scene);
  const auto all = static_cast<double>(whole.valid_count());
  EXPECT_NEAR(static_cast<double>(grid.valid_count()) / all, 0.98, 0.005);
  int strays = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      EXPECT_NEAR(std::remainder(grid.z[i], 0.25F), 0.0F, 1e-5F);
      strays += std::abs(grid.z[i]) > 0.3F ? 1 : 0;
    }
  }
  EXPECT_NEAR(strays / all, 0.01, 0.003);
}

TEST(Scanner, RowsStreamInOrderAndRepeatToTheByte) {
  ScannerOptions options;
  options.spacing_mm = 0.3;
  TabletOptions clay = small_clean_tablet();
  clay.spacing_mm = 0.4;
  const TestScene scene(make_or_fail(clay));
  const RangeGrid grid = scan(options, scene, tilted(10), 3);
  JobContext job;
  int next = 0;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Status done = TriangulationScanner(options).scan(
      scene.scene, tilted(10), 3,
      [&](const ProfileRow& row) {
        EXPECT_EQ(row.row, next++);
        EXPECT_EQ(std::memcmp(row.z.data(), &grid.z[grid.index(row.row, 0)], row.z.size_bytes()), 0);
        EXPECT_EQ(std::memcmp(row.valid.data(), &grid.valid[grid.index(row.row, 0)], row.valid.size_bytes()),
                  0);
        return true;
      },
      job);
  EXPECT_TRUE(done);
  EXPECT_EQ(next, grid.rows);
  EXPECT_NE(scan(options, scene, tilted(10), 4).z, grid.z);
}

TEST(Scanner, ViewTellsWhereLaserAndCameraWere) {
  const TestScene scene(plane(12, 0, 0.6F));
  const RangeGrid grid = scan(perfect(), scene);
  for (const int row : {0, grid.rows / 2, grid.rows - 1}) {
    for (int c = 0; c < grid.cols; ++c) {
      if (grid.is_valid(row, c)) {
        const double laser_y = grid.view.laser_mm->y() + row * grid.view.motion_per_row_mm.y();
        EXPECT_NEAR(grid.y[grid.index(row, c)], laser_y, 1e-4);
      }
    }
  }
  EXPECT_NEAR(grid.view.camera_mm->y() - grid.view.laser_mm->y(), perfect().baseline_mm, 1e-9);
}

TEST(Scanner, OnlyThePartOfTheFieldWithClayIsScanned) {
  const TestScene small(plane(5, 0, 0.6F));
  const RangeGrid grid = scan(perfect(), small);
  EXPECT_NEAR(grid.rows * 0.2, 10 + 2 * perfect().margin_mm, 0.5);
  EXPECT_NEAR(grid.cols * 0.2, 10 + 2 * perfect().margin_mm, 0.5);
  const RangeGrid none = scan(perfect(), small, {Eigen::Matrix3d::Identity(), {500, 0, 0}});
  EXPECT_EQ(none.rows, 0);
  EXPECT_EQ(none.size(), 0U);
}

TEST(Scanner, GrowsWithTheTablet) {
  const ScannerOptions usual = scanner_for({30, 25, 15}, 0.05, 0.01);
  EXPECT_EQ(usual.field_x_mm, ScannerOptions{}.field_x_mm);
  EXPECT_EQ(usual.spacing_mm, 0.05);
  const ScannerOptions big = scanner_for({150, 120, 35}, 0.2, 0.02);
  EXPECT_GT(big.field_x_mm, 195);
  EXPECT_GT(big.depth_range_mm, 195);
  EXPECT_NEAR(big.baseline_mm / big.standoff_mm, usual.baseline_mm / usual.standoff_mm, 1e-12);
}

TEST(Scanner, StopsWhenTheSinkOrTheJobSaysSo) {
  const TestScene scene(plane(10, 0, 0.6F));
  JobContext job;
  int rows = 0;
  const Status refused = TriangulationScanner(perfect()).scan(
      scene.scene, {}, 0, [&](const ProfileRow&) { return ++rows < 5; }, job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(rows, 5);
  job.cancel();
  const Status cancelled = TriangulationScanner(perfect()).scan(
      scene.scene, {}, 0, [&](const ProfileRow&) { return true; }, job);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar::sim
