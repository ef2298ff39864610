// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/relief.h"

#include <gtest/gtest.h>

#include "registration/scan_surface.h"
#include "registration/verify_pose.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

using testing::bumpy;
using testing::FieldScan;
using testing::pose_of;
using testing::scan_field;

/// Hollows of the size of wedges on a body that looks the same under a half turn, as tablets do.
testing::Height written(std::uint64_t seed) {
  struct Hollow {
    double x, y, depth, width;
  };
  std::vector<Hollow> hollows;
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(-26, 26);
    const double y = random.uniform(-26, 26);
    hollows.push_back({x, y, random.uniform(0.2, 0.5), random.uniform(0.7, 1.6)});
  }
  return [hollows](double x, double y) {
    double z = -(x * x + y * y) / 120.0;
    for (const Hollow& h : hollows) {
      const double r2 = ((x - h.x) * (x - h.x) + (y - h.y) * (y - h.y)) / (h.width * h.width);
      z -= r2 < 16 ? h.depth * std::exp(-r2) : 0.0;
    }
    return z;
  };
}

std::shared_ptr<const ScanSurface> surface_of(const testing::Height& height, const RigidTransform& pose,
                                              std::uint64_t seed) {
  FieldScan scan;
  scan.seed = seed;
  ScanSurfaceOptions options;
  options.scale_mm = 50;
  return make_scan_surface(scan_field(height, pose, scan), {}, options);
}

ReliefAgreement agreement(const ScanSurface& source, const ScanSurface& target, const RigidTransform& pose) {
  return relief_agreement(*source.medium, source.relief, *target.medium, target.relief, pose, 1.0);
}

TEST(Relief, AgreesInTheRightPoseOnly) {
  const RigidTransform from = pose_of(8, -5, 70, {2, 1, 3});
  const auto a = surface_of(written(3), {}, 1);
  const auto b = surface_of(written(3), from, 2);
  const ReliefAgreement right = agreement(*b, *a, from);
  EXPECT_GT(right.correlation(), 0.8);
  EXPECT_GT(right.significance(b->relief.radius_mm), 15.0);
  EXPECT_GT(right.area_mm2, 1000.0);
  // The body fits as well after a half turn; what is on it does not.
  const ReliefAgreement turned = agreement(*b, *a, pose_of(0, 0, 180, {0, 0, 0}) * from);
  EXPECT_GT(turned.area_mm2, 1000.0);
  EXPECT_LT(std::abs(turned.significance(b->relief.radius_mm)), 5.0);
  const RigidTransform slid = pose_of(0, 0, 0, {3, 0, 0}) * from;
  EXPECT_LT(agreement(*b, *a, slid).correlation(), 0.5 * right.correlation());
}

TEST(Relief, OfAnotherTextDoesNotAgree) {
  const auto a = surface_of(written(3), {}, 1);
  for (std::uint64_t seed = 20; seed < 23; ++seed) {
    const auto other = surface_of(written(seed), {}, seed);
    EXPECT_LT(std::abs(agreement(*other, *a, {}).significance(a->relief.radius_mm)), 5.0) << seed;
  }
}

TEST(Relief, TakesTheBendOfTheBodyOff) {
  const auto blank = [](double x, double y) { return -(x * x + y * y) / 120.0; };
  const auto a = surface_of(blank, {}, 1);
  const auto b = surface_of(blank, {}, 2);
  EXPECT_LT(a->relief.rms_mm, 0.02);  // the noise of a cell, not the millimetres of the body
  EXPECT_LT(std::abs(agreement(*b, *a, {}).correlation()), 0.25);
}

TEST(Relief, SharpRimsAreToldApart) {
  // A roof, seen from above its ridge: slid along the ridge it lies on itself as before, and nothing is
  // written there.
  const auto roof = [](double x, double) { return -std::abs(x); };
  const auto a = surface_of(roof, {}, 1);
  const auto b = surface_of(roof, {}, 2);
  const ReliefAgreement slid = agreement(*b, *a, pose_of(0, 0, 0, {0, 5, 0}));
  EXPECT_GT(slid.area_mm2, 500.0);
  EXPECT_GT(slid.significance(a->relief.radius_mm), 20.0);
  EXPECT_LT(slid.significance_off_rims(a->relief.radius_mm),
            VerifyOptions{}.least_off_rims * slid.significance(a->relief.radius_mm));
}

TEST(Relief, OfNothingIsNothing) {
  ScanSurfaceOptions options;
  options.scale_mm = 50;
  const auto empty = make_scan_surface(RangeGrid{}, {}, options);
  EXPECT_TRUE(empty->relief.cells.empty());
  const auto a = surface_of(written(3), {}, 1);
  EXPECT_EQ(agreement(*empty, *a, {}).significance(1.0), 0.0);
  EXPECT_EQ(agreement(*a, *empty, {}).correlation(), 0.0);
}

}  // namespace
}  // namespace dubsar
