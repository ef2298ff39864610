// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/surface_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numeric>

#include "core/units.h"
#include "planning/checklist.h"
#include "planning/sparse_flags.h"

namespace dubsar {
namespace {

constexpr double kHalfMm = 10;

/// A flat square of 20 x 20 mm in the plane z = 0, in triangles of about half a millimetre, seen from +z.
Mesh flat_square() {
  constexpr int kSide = 41;
  Mesh mesh;
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      mesh.positions.emplace_back(static_cast<float>(-kHalfMm + c * 0.5),
                                  static_cast<float>(-kHalfMm + r * 0.5), 0.0F);
    }
  }
  const auto at = [](int r, int c) { return static_cast<std::uint32_t>(r * kSide + c); };
  for (int r = 0; r + 1 < kSide; ++r) {
    for (int c = 0; c + 1 < kSide; ++c) {
      mesh.faces.push_back({at(r, c), at(r, c + 1), at(r + 1, c + 1)});
      mesh.faces.push_back({at(r, c), at(r + 1, c + 1), at(r + 1, c)});
    }
  }
  mesh.flags.assign(mesh.positions.size(), 0);
  return mesh;
}

/// The square (and 2 mm more on each side) from far off, tilted about x, with µ across the view.
RangeGrid scan_of_square(double spacing_mm, double tilt_rad) {
  RangeGrid grid;
  const int cols = static_cast<int>(24 / spacing_mm);
  const int rows = static_cast<int>(24 * std::cos(tilt_rad) / spacing_mm);
  grid.allocate(rows, cols);
  grid.spacing_mm = spacing_mm;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const std::size_t i = grid.index(r, c);
      const double y = (r - rows / 2.0 + 0.3) * spacing_mm;
      grid.x[i] = static_cast<float>((c - cols / 2.0 + 0.3) * spacing_mm);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(y * std::tan(tilt_rad));
      grid.valid[i] = 1;
    }
  }
  return grid;
}

class SurfaceQualityOfASquare : public ::testing::Test {
 protected:
  void add(double spacing_mm, double tilt_rad = 0, bool from_below = false) {
    grids_.push_back(scan_of_square(spacing_mm, tilt_rad));
    flags_.push_back(flag_sparse(grids_.back()));
    PlacedScan scan;
    scan.id = static_cast<int>(scans_.size());
    scan.grid = &grids_.back();
    scan.flags = &flags_.back();
    // The scanner's frame has the surface tilted; in the model it lies flat.
    scan.model_from_scanner.rotation =
        Eigen::AngleAxisd(-tilt_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
    if (from_below) {
      scan.model_from_scanner.rotation = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()).toRotationMatrix() *
                                         scan.model_from_scanner.rotation;
    }
    scans_.push_back(scan);
  }
  [[nodiscard]] SurfaceQuality quality() const { return surface_quality(scans_, mesh_, ModelFaces{}); }

  Mesh mesh_ = flat_square();
  std::deque<RangeGrid> grids_;
  std::deque<SampleFlags> flags_;
  std::vector<PlacedScan> scans_;
};

TEST_F(SurfaceQualityOfASquare, OneScanFromAbove) {
  add(0.1);
  const SurfaceQuality found = quality();
  EXPECT_NEAR(found.seen_mm2[static_cast<std::size_t>(Face::kObverse)], 400, 1e-3);
  EXPECT_NEAR(found.all.places, 60000, 1);
  EXPECT_EQ(found.faces[0].places, found.all.places) << "all of it looks to the obverse";
  EXPECT_NEAR(found.all.spacing_mm.median, 0.1, 1e-4);
  EXPECT_NEAR(found.all.single_spacing_mm.p95, 0.1, 1e-4);
  EXPECT_NEAR(found.all.incidence_rad.p95, 0, 1e-3);
  EXPECT_EQ(found.all.scans_share[1], 1.0);
  EXPECT_EQ(found.all.incidence_share[0], 1.0);
  EXPECT_EQ(found.all.fine_share, 0.0);
}

TEST_F(SurfaceQualityOfASquare, ASlopeStretchesTheSpacing) {
  add(0.1, rad_from_deg(60));
  const SurfaceQuality found = quality();
  EXPECT_NEAR(found.all.single_spacing_mm.median, 0.2, 1e-3) << "one over the cosine of 60 degrees";
  EXPECT_NEAR(found.all.spacing_mm.median, std::sqrt(0.1 * 0.2), 1e-3) << "a cell is 0.1 by 0.2 mm";
  EXPECT_NEAR(deg_from_rad(found.all.incidence_rad.median), 60, 0.1);
}

TEST_F(SurfaceQualityOfASquare, OverlapsAddUpAndTheBestAngleCounts) {
  add(0.1);
  add(0.1);
  add(0.1, rad_from_deg(60));
  const SurfaceQuality found = quality();
  EXPECT_NEAR(found.all.spacing_mm.median, 1 / std::sqrt(100 + 100 + 50), 1e-3);
  EXPECT_NEAR(found.all.single_spacing_mm.median, 0.1, 1e-4);
  EXPECT_NEAR(deg_from_rad(found.all.incidence_rad.median), 0, 0.1);
  EXPECT_EQ(found.all.scans_share[3], 1.0);
}

void expect_same(const SamplingQuality& a, const SamplingQuality& b) {
  EXPECT_EQ(a.places, b.places);
  EXPECT_EQ(a.spacing_mm.median, b.spacing_mm.median);
  EXPECT_EQ(a.spacing_mm.p95, b.spacing_mm.p95);
  EXPECT_EQ(a.single_spacing_mm.median, b.single_spacing_mm.median);
  EXPECT_EQ(a.scans_share, b.scans_share);
}

/// In the checklist, whether it is among the scans that are handed in or was left out before.
TEST_F(SurfaceQualityOfASquare, ACopyCountsAsTheScanThatItIsOf) {
  add(0.2);
  add(0.2, rad_from_deg(40));
  std::vector<ScanPose> poses(2);
  poses[1].id = 1;
  poses[0].status = poses[1].status = PoseStatus::kRegistered;
  RedMap map;
  const Checklist once = make_checklist(map, poses, scans_, mesh_, nullptr);
  ASSERT_EQ(once.sampling.scans_share[2], 1.0);
  EXPECT_TRUE(once.warnings.empty());

  scans_.push_back(scans_[1]);
  scans_[2].id = 7;
  ASSERT_EQ(make_checklist(map, poses, scans_, mesh_, nullptr).sampling.scans_share[3], 1.0)
      << "as a scan of its own";
  poses.push_back(poses[1]);
  poses[2].id = 7;
  poses[2].sigma_mm = 3;
  map.copies = {{7, 1}};
  for (const bool handed_in : {true, false}) {
    const Checklist twice = make_checklist(map, poses, scans_, mesh_, nullptr);
    expect_same(twice.sampling, once.sampling);
    for (std::size_t face = 0; face < kFaceCount; ++face) {
      expect_same(twice.faces[face].sampling, once.faces[face].sampling);
      EXPECT_EQ(twice.faces[face].seen_mm2, once.faces[face].seen_mm2);
    }
    EXPECT_EQ(twice.scans_registered, 2);
    EXPECT_NE(twice.worst_sigma_scan, 7);
    ASSERT_EQ(twice.warnings.size(), 1U) << handed_in;
    EXPECT_EQ(twice.warnings[0].scan, 7);
    EXPECT_EQ(twice.warnings[0].text, "it has the very samples of scan 1, and counts as the same scan");
    scans_.pop_back();
  }
}

TEST_F(SurfaceQualityOfASquare, AMuchCoarserScanIsTold) {
  add(0.1);
  add(0.14);
  ASSERT_TRUE(make_checklist({}, {}, scans_, mesh_, nullptr).warnings.empty());
  add(0.5);
  const Checklist list = make_checklist({}, {}, scans_, mesh_, nullptr);
  ASSERT_EQ(list.warnings.size(), 1U);
  EXPECT_EQ(list.warnings[0].scan, scans_.back().id);
  EXPECT_EQ(list.warnings[0].text,
            "its samples lie 0.5 mm apart, those of the finest scan 0.1 mm: where it looked, gaps of up to "
            "1.5 mm count as sampled; take it out if that is not meant");
}

TEST_F(SurfaceQualityOfASquare, AMuchNoisierScanIsTold) {
  add(0.1);
  add(0.1);
  add(0.1);
  for (PlacedScan& scan : scans_) {
    scan.noise_mm = 0.01;
  }
  scans_[1].noise_mm = 0.029;
  ASSERT_TRUE(make_checklist({}, {}, scans_, mesh_, nullptr).warnings.empty());
  scans_[1].noise_mm = 0.05;
  const Checklist list = make_checklist({}, {}, scans_, mesh_, nullptr);
  ASSERT_EQ(list.warnings.size(), 1U);
  EXPECT_EQ(list.warnings[0].scan, scans_[1].id);
  EXPECT_EQ(list.warnings[0].text,
            "its samples scatter by 50 µm, half of the other scans by no more than 10 µm: clay that it alone "
            "saw is as noisy; take it out and scan that anew");
  // A tenth of the spacing does not matter, whatever the others do.
  for (PlacedScan& scan : scans_) {
    scan.noise_mm = 0.001;
  }
  scans_[1].noise_mm = 0.01;
  EXPECT_TRUE(make_checklist({}, {}, scans_, mesh_, nullptr).warnings.empty());
}

TEST_F(SurfaceQualityOfASquare, FineIsFine) {
  add(0.05);
  EXPECT_EQ(quality().all.fine_share, 0.0);
  for (int more = 0; more < 3; ++more) {
    add(0.05);
  }
  add(0.05);
  const SurfaceQuality found = quality();
  EXPECT_EQ(found.all.fine_share, 1.0) << "five together: 0.05 mm / sqrt(5)";
  EXPECT_EQ(found.all.single_fine_share, 0.0);
}

TEST_F(SurfaceQualityOfASquare, WhatIsSparseOrLooksAtTheOtherSideCountsForNothing) {
  add(0.1, 0, true);  // the back of the sheet: its samples lie at the same places
  EXPECT_EQ(quality().all.scans_share[0], 1.0);
  add(0.1, rad_from_deg(75));  // rows farther apart than 3 µ on the surface
  const SurfaceQuality found = quality();
  EXPECT_EQ(found.all.scans_share[0], 1.0);
  EXPECT_TRUE(std::isinf(found.all.spacing_mm.median));
}

TEST_F(SurfaceQualityOfASquare, HalfSeenIsHalf) {
  add(0.1);
  RangeGrid& grid = grids_.back();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = grid.x[i] < 0 ? 1 : 0;
  }
  flags_.back() = flag_sparse(grid);
  const SurfaceQuality found = quality();
  EXPECT_NEAR(found.all.scans_share[1], 0.5, 0.02);
  EXPECT_NEAR(std::accumulate(found.all.incidence_share.begin(), found.all.incidence_share.end(), 0.0), 0.5,
              0.02);
  EXPECT_TRUE(std::isinf(found.all.spacing_mm.p95));
}

TEST_F(SurfaceQualityOfASquare, InterpolatedSurfaceIsNotSeen) {
  add(0.1);
  for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
    mesh_.flags[v] = mesh_.positions[v].x() > 5.1F ? kVertexInterpolated : 0;
  }
  const SurfaceQuality found = quality();
  EXPECT_NEAR(found.seen_mm2[0], 300, 1e-3);
  EXPECT_NEAR(found.interpolated_mm2[0], 100, 1e-3);
}

TEST_F(SurfaceQualityOfASquare, NothingIsNothing) {
  EXPECT_EQ(quality().all.scans_share[0], 1.0) << "no scan";
  mesh_ = {};
  const SurfaceQuality found = quality();
  EXPECT_EQ(found.all.places, 0);
  EXPECT_EQ(found.seen_mm2[0], 0);
  mesh_.positions.resize(2);
  mesh_.faces.push_back({0, 1, 7});
  EXPECT_EQ(quality().all.places, 0) << "an index out of range";
}

}  // namespace
}  // namespace dubsar
