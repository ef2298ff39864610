// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/convex_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/random.h"
#include "core/units.h"

namespace dubsar {
namespace {

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f& a = mesh.positions[f[0]];
    area += 0.5 * (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a).norm();
  }
  return area;
}

/// Every edge is met once from either side, and there are as many faces as corners ask for.
void expect_closed(const Mesh& hull) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::set<std::uint32_t> corners;
  for (const auto& f : hull.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(edges.emplace(f[k], f[(k + 1) % 3]).second);
      corners.insert(f[k]);
    }
  }
  for (const auto& [from, to] : edges) {
    EXPECT_TRUE(edges.contains({to, from}));
  }
  EXPECT_EQ(hull.faces.size(), 2 * corners.size() - 4);
}

Eigen::Matrix3d some_rotation(Random& random) {
  Eigen::Vector4d q;
  for (double& part : q) {
    part = random.normal();
  }
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

TEST(ConvexHull, OfABoxHasTwelveFaces) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back(30.0 * (i & 1), 20.0 * (i >> 1 & 1), 10.0 * (i >> 2 & 1));
  }
  points.emplace_back(15, 10, 5);
  points.emplace_back(15, 10, 10);  // in a side
  points.emplace_back(15, 20, 10);  // on an edge
  points.push_back(points[3]);
  const Mesh hull = convex_hull(points);
  expect_closed(hull);
  EXPECT_NEAR(area_of(hull), 2.0 * (600 + 300 + 200), 1e-6);
}

TEST(ConvexHull, StaysWholeWherePointsLieInPlanesAndOnLines) {
  // A plate of raster points, as samples of grids lie, clamped into planes on two sides and turned: no two
  // products of sines are rounded alike.
  Random random(5);
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::Matrix3d turn = some_rotation(random);
    std::vector<Eigen::Vector3d> points;
    for (int row = 0; row < 20; ++row) {
      for (int col = 0; col < 24; ++col) {
        const double x = 30.0 * (col / 23.0 - 0.5);
        const double y = 25.0 * (row / 19.0 - 0.5);
        const double bulge = 9.0 * (1 - std::pow(x / 20, 2) - std::pow(y / 18, 2));
        points.emplace_back(turn * Eigen::Vector3d(x, y, std::min(bulge, 5.0)));
        points.emplace_back(turn * Eigen::Vector3d(x, y, std::max(-bulge, -4.0)));
      }
    }
    for (Eigen::Vector3d& p : points) {
      p = p.cast<float>().cast<double>();
    }
    const Mesh hull = convex_hull(points);
    expect_closed(hull);
    const double box_mm2 = 2 * (30 * 25.0 + 30 * 9 + 25 * 9);
    EXPECT_LT(area_of(hull), box_mm2);
    EXPECT_GT(area_of(hull), 0.7 * box_mm2);
    if (testing::Test::HasFailure()) {
      FAIL() << "trial " << trial;
    }
  }
}

TEST(ConvexHull, OfPointsInAPlaneThereIsNone) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 50; ++i) {
    points.emplace_back(std::cos(i * 1.0), std::sin(i * 1.0), 0.25 * std::cos(i * 1.0));
  }
  EXPECT_TRUE(convex_hull(points).faces.empty());
  EXPECT_TRUE(convex_hull(std::vector<Eigen::Vector3d>(9, Eigen::Vector3d(1, 2, 3))).faces.empty());
  EXPECT_TRUE(convex_hull(std::vector<Eigen::Vector3d>{}).faces.empty());
}

TEST(ConvexHull, OfABoxIsTheBox) {
  std::vector<Eigen::Vector3d> points;
  for (const double x : {0.0, 1.0, 2.0}) {
    for (const double y : {0.0, 1.0, 3.0}) {
      for (const double z : {0.0, 1.0, 4.0}) {
        points.emplace_back(x, y, z);
      }
    }
  }
  EXPECT_NEAR(surface_area_mm2(convex_hull(points)), 2 * (6 + 8 + 12), 1e-4);
  EXPECT_TRUE(convex_hull(std::vector<Eigen::Vector3d>(5, Eigen::Vector3d::Zero())).faces.empty());
}

}  // namespace
}  // namespace dubsar
