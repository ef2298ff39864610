// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/model_faces.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "core/range_grid.h"
#include "planning/convex_hull.h"

namespace dubsar {
namespace {

/// Seen from above by a scan whose y axis runs along the model's.
Eigen::Vector3d top_of(double width_mm, double height_mm, double turned_rad) {
  RangeGrid grid;
  PlacedScan scan;
  scan.id = 1;
  scan.grid = &grid;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double z : {-6.0, 6.0}) {
        corners.push_back(turn * Eigen::Vector3d(x * width_mm, y * height_mm, z));
      }
    }
  }
  return model_faces({&scan, 1}, convex_hull(corners)).normal(Face::kTop);
}

TEST(ModelFaces, UpIsAlongTheEdgesAsTheFirstScanSawItWhetherHighOrWide) {
  const Eigen::Vector3d up(-std::sin(0.2), std::cos(0.2), 0);
  EXPECT_GT(top_of(44, 50, 0.2).dot(up), 0.999);
  EXPECT_GT(top_of(50, 44, 0.2).dot(up), 0.999);
  EXPECT_GT(top_of(50, 44, 1.2).dot(Eigen::Vector3d(std::cos(1.2), std::sin(1.2), 0)), 0.999);
}

/// The principal axes are chance: they might lead along a diagonal.
TEST(ModelFaces, WhatIsAsWideAsHighStandsAsTheFirstScanSawIt) {
  for (const double wider_mm : {-0.2, 0.0, 0.2}) {
    for (const double turned_rad : {0.0, 0.3, 0.785, 1.2}) {
      EXPECT_GT(top_of(40 + wider_mm, 40, turned_rad).y(), 0.999) << wider_mm << " mm, " << turned_rad;
    }
  }
}

}  // namespace
}  // namespace dubsar
