// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/align_near.h"

#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

std::shared_ptr<const ScanSurface> view(const testing::Height& height,
                                        const RigidTransform& model_from_scanner, std::uint64_t seed) {
  testing::FieldScan scan;
  scan.seed = seed;
  return make_scan_surface(testing::scan_field(height, model_from_scanner, scan), {}, {.scale_mm = 50});
}

TEST(AlignNear, FindsThePoseFromFarOff) {
  const testing::Height height = testing::bumpy(11);
  const RigidTransform model_from_a = testing::pose_of(10, -5, 0, {0, 0, 0});
  const RigidTransform model_from_b = testing::pose_of(-12, 8, 40, {3, -2, 1});
  const auto a = view(height, model_from_a, 1);
  const auto b = view(height, model_from_b, 2);
  const ModelScan model{a.get(), model_from_a};
  for (int k = 0; k < 6; ++k) {
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    const RigidTransform turn =
        RigidTransform::from_twist(side * rad_from_deg(18.0) * Eigen::Vector3d::Unit(k / 2), {0, 0, 0});
    const Eigen::Vector3d center = model_from_b * b->centroid_mm;
    const RigidTransform start{turn.rotation * model_from_b.rotation,
                               turn.rotation * (model_from_b.translation_mm - center) + center +
                                   side * 6.0 * Eigen::Vector3d::Unit((k / 2 + 1) % 3)};
    const auto fits = align_near(*b, {&model, 1}, start, {});
    ASSERT_FALSE(fits.empty());
    const RigidTransform& found = fits.front().model_from_scanner;
    EXPECT_LT((found * b->centroid_mm - center).norm(), 0.05) << k;
    EXPECT_LT(deg_from_rad(
                  RigidTransform{found.rotation * model_from_b.rotation.transpose(), {0, 0, 0}}.angle_rad()),
              0.1)
        << k;
  }
}

TEST(AlignNear, NothingToAlignWith) {
  const testing::Height height = testing::bumpy(12);
  const auto a = view(height, {}, 1);
  EXPECT_TRUE(align_near(*a, {}, {}, {}).empty());
  const auto empty = make_scan_surface(RangeGrid{}, {}, {});
  const ModelScan model{a.get(), {}};
  EXPECT_TRUE(align_near(*empty, {&model, 1}, {}, {}).empty());
}

}  // namespace
}  // namespace dubsar
