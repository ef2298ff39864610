// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/resample.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/random.h"

namespace dubsar {
namespace {

using Key = std::array<float, 3>;

std::set<Key> keys_of(const std::vector<Eigen::Vector3f>& points) {
  std::set<Key> out;
  for (const Eigen::Vector3f& p : points) {
    out.insert({p.x(), p.y(), p.z()});
  }
  return out;
}

/// Every sample is a point of the cloud, none is used twice.
void expect_measured(const RangeGrid& grid, const PointCloud& cloud) {
  const std::set<Key> measured = keys_of(cloud.points);
  std::set<Key> seen;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      const Key key{grid.x[i], grid.y[i], grid.z[i]};
      EXPECT_TRUE(measured.contains(key));
      EXPECT_TRUE(seen.insert(key).second);
    }
  }
}

/// A gently curved sheet of count × count points every 0.2 mm, turned about z, shuffled.
PointCloud sheet(int count, double turn_rad, double jitter = 0.0) {
  PointCloud cloud;
  Random random(3);
  for (int row = 0; row < count; ++row) {
    for (int col = 0; col < count; ++col) {
      const double x = 0.2 * (col - count / 2) + jitter * random.normal();
      const double y = 0.2 * (row - count / 2) + jitter * random.normal();
      cloud.points.emplace_back(std::cos(turn_rad) * x - std::sin(turn_rad) * y,
                                std::sin(turn_rad) * x + std::cos(turn_rad) * y, 0.5 * std::sin(0.3 * x));
    }
  }
  for (std::size_t i = cloud.points.size(); i > 1; --i) {
    std::swap(cloud.points[i - 1], cloud.points[random.below(i)]);
  }
  return cloud;
}

TEST(Resample, AnUpRightLatticeComesBackWhole) {
  JobContext job;
  const PointCloud cloud = sheet(60, 0);
  const RangeGrid grid = resample(cloud, {}, job).value();
  EXPECT_NEAR(grid.spacing_mm, 0.2, 0.01);
  EXPECT_EQ(grid.rows, 60);
  EXPECT_EQ(grid.cols, 60);
  EXPECT_EQ(grid.valid_count(), cloud.points.size());
  EXPECT_NEAR(grid.view.direction.z(), -1, 0.02);
  expect_measured(grid, cloud);
  // Columns follow x, rows y.
  EXPECT_LT(grid.x[grid.index(30, 10)], grid.x[grid.index(30, 11)]);
  EXPECT_LT(grid.y[grid.index(10, 30)], grid.y[grid.index(11, 30)]);
}

TEST(Resample, ATurnedOrJitteredLatticeLeavesFewHolesInside) {
  JobContext job;
  for (const auto& [turn, jitter] : {std::pair(0.4, 0.0), std::pair(0.785, 0.0), std::pair(0.2, 0.02)}) {
    const PointCloud cloud = sheet(80, turn, jitter);
    const RangeGrid grid = resample(cloud, {}, job).value();
    expect_measured(grid, cloud);
    EXPECT_GT(grid.valid_count(), cloud.points.size() * 85 / 100) << turn;
    int cells = 0;
    int holes = 0;
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        // The middle of the cell, from the grid's corner at the cloud's lowest x and y.
        const double half = 0.5 * grid.spacing_mm;
        const double x = (col - grid.cols / 2) * grid.spacing_mm + half;
        const double y = (row - grid.rows / 2) * grid.spacing_mm + half;
        if (std::hypot(x, y) < 7.0) {
          ++cells;
          holes += grid.is_valid(row, col) ? 0 : 1;
        }
      }
    }
    EXPECT_LT(holes, cells / 50) << turn << " of " << cells;
  }
}

TEST(Resample, OfTwoSurfacesTheFirstIsSeen) {
  JobContext job;
  PointCloud cloud = sheet(40, 0);
  const std::size_t front = cloud.points.size();
  for (std::size_t i = 0; i < front; ++i) {
    cloud.points.push_back(cloud.points[i] - Eigen::Vector3f(0.01F, 0.01F, 10.0F));
  }
  ResampleOptions options;
  options.view_direction = Eigen::Vector3d(0, 0, -1);
  const RangeGrid grid = resample(cloud, options, job).value();
  std::size_t seen = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && grid.row_of(i) > 0 && grid.col_of(i) > 0) {
      EXPECT_GT(grid.z[i], -5);
      ++seen;
    }
  }
  EXPECT_GT(seen, front * 3 / 4) << "nor is it lost where the other lies behind it";
}

TEST(Resample, NormalsDecideTheView) {
  JobContext job;
  PointCloud cloud = sheet(30, 0);
  cloud.normals.assign(cloud.points.size(), Eigen::Vector3f(0, 0, -1));
  cloud.intensity.assign(cloud.points.size(), 0.25F);
  cloud.rgb.assign(3 * cloud.points.size(), 77);
  const RangeGrid grid = resample(cloud, {}, job).value();
  EXPECT_NEAR(grid.view.direction.z(), 1, 1e-6);
  EXPECT_EQ(grid.intensity[grid.index(5, 5)], 0.25F);
  EXPECT_EQ(grid.rgb.size(), 3 * grid.size());
}

/// A long thumb seen from its tip, with a knuckle that hides what lies behind it.
PointCloud thumb(const Eigen::Matrix3d& turn) {
  PointCloud cloud;
  for (double x = -10; x <= 10; x += 0.3) {
    for (double y = -12; y <= 12; y += 0.3) {
      const double body = 1 - x * x / 81 - y * y / 121;
      const double knuckle = 1 - (x - 4) * (x - 4) / 9 - (y - 3) * (y - 3) / 9;
      if (body > 0.01) {
        const double z = knuckle > 0.01 ? 34 + 3 * std::sqrt(knuckle) : 30 * std::sqrt(body);
        cloud.points.push_back((turn * Eigen::Vector3d(x, y, z)).cast<float>());
      }
    }
  }
  return cloud;
}

TEST(Resample, AScanThatIsDeeperThanWideIsSeenAlongItsDepth) {
  JobContext job;
  const auto grid = resample(thumb(Eigen::Matrix3d::Identity()), {}, job);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->view.direction, Eigen::Vector3d(0, 0, -1));
}

TEST(Resample, AScanInAFrameThatIsNotTheScannersIsSeenAlongItsDepth) {
  JobContext job;
  for (const double turn_rad : {0.5, 0.9, 1.3, 1.6, 2.0, 2.4, 2.8}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
    const auto grid = resample(thumb(turn), {}, job);
    ASSERT_TRUE(grid);
    EXPECT_GT(grid->view.direction.dot(turn * Eigen::Vector3d(0, 0, -1)), std::cos(0.35)) << turn_rad;
  }
}

TEST(Resample, StraysFarAwayDoNotBlowUpTheGrid) {
  JobContext job;
  PointCloud cloud = sheet(60, 0);
  cloud.points[10] = {5e5F, 0, 0};
  cloud.points[11] = {0, -5e5F, 0};
  cloud.points[12].x() = std::numeric_limits<float>::quiet_NaN();
  ResampleOptions options;
  options.view_direction = Eigen::Vector3d(0, 0, -1);
  const RangeGrid grid = resample(cloud, options, job).value();
  EXPECT_LT(grid.rows, 200);
  EXPECT_LT(grid.cols, 200);
  EXPECT_GE(grid.valid_count(), cloud.points.size() - 5);
}

TEST(Resample, RefusesWhatIsNoSurface) {
  JobContext job;
  EXPECT_EQ(resample({}, {}, job).error().kind, ErrorKind::kBadInput);
  PointCloud spot;
  spot.points.assign(100, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(resample(spot, {}, job).error().kind, ErrorKind::kBadInput);
  ResampleOptions options;
  options.spacing_mm = -1;
  EXPECT_EQ(resample(sheet(5, 0), options, job).error().kind, ErrorKind::kUsage);
  job.cancel();
  EXPECT_EQ(resample(sheet(5, 0), {}, job).error().kind, ErrorKind::kCancelled);
}

TEST(Resample, TheSamePointsGiveTheSameGrid) {
  JobContext job;
  const RangeGrid a = resample(sheet(50, 0.3, 0.02), {}, job).value();
  const RangeGrid b = resample(sheet(50, 0.3, 0.02), {}, job).value();
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.valid, b.valid);
}

}  // namespace
}  // namespace dubsar
