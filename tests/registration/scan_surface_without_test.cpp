// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "registration/scan_surface.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

/// What is left out of the right half is matched on no level, and yet stands before what lies behind it.
TEST(ScanSurfaceWithout, WhatIsLeftOutIsNotMatchedAndStillHides) {
  const RangeGrid grid = testing::scan_field(testing::bumpy(3), {}, {});
  const ScanSurfaceOptions options;
  const auto whole = make_scan_surface(grid, {}, options);
  const RangeGrid& fine = whole->fine->grid;
  std::vector<std::uint8_t> right(fine.size(), 0);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    right[i] = fine.valid[i] != 0 && fine.x[i] > 0 ? 1 : 0;
  }
  const auto half = without(*whole, right, options);

  for (const auto level : {&ScanSurface::fine, &ScanSurface::medium, &ScanSurface::coarse}) {
    const SurfaceLevel& of_half = *((*half).*level);
    const SurfaceLevel& of_whole = *((*whole).*level);
    ASSERT_FALSE(of_half.samples.empty());
    for (const SurfaceSample& sample : of_half.samples) {
      EXPECT_LE(sample.position_mm.x(), 0.0F);
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < of_half.usable.size(); ++i) {
      EXPECT_LE(of_half.usable[i], of_whole.usable[i]);
      EXPECT_TRUE(of_half.usable[i] == 0 || of_half.grid.x[i] <= 0.0F);
      kept += of_half.usable[i];
    }
    EXPECT_GT(kept, 0U);
    for (const SurfaceSample& sample : of_whole.samples) {
      const DepthRaster::Cell* cell = of_half.raster.at(sample.position_mm);
      ASSERT_NE(cell, nullptr);
      EXPECT_GE(cell->sample, 0);
    }
  }
  for (const std::uint32_t cell : half->relief.cells) {
    EXPECT_LE(half->medium->grid.x[cell], 0.0F);
  }
  EXPECT_LT(half->centroid_mm.x(), -5.0);
  EXPECT_LT(half->extent_mm, whole->extent_mm);
  EXPECT_EQ(half->scale_mm, whole->scale_mm);
  EXPECT_EQ(half->noise_mm, whole->noise_mm);
}

/// With nothing left out it is the same surface.
TEST(ScanSurfaceWithout, NothingLeftOutChangesNothing) {
  const RangeGrid grid = testing::scan_field(testing::bumpy(5), {}, {});
  const ScanSurfaceOptions options;
  const auto whole = make_scan_surface(grid, {}, options);
  const auto same = without(*whole, std::vector<std::uint8_t>(whole->fine->grid.size(), 0), options);
  EXPECT_EQ(same->fine->usable, whole->fine->usable);
  ASSERT_EQ(same->medium->samples.size(), whole->medium->samples.size());
  EXPECT_EQ(same->relief.cells, whole->relief.cells);
  EXPECT_TRUE(same->centroid_mm.isApprox(whole->centroid_mm));
}

}  // namespace
}  // namespace dubsar
