// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pair_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/units.h"
#include "registration/footprint.h"
#include "registration/model_fit.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

/// A cushion with ripples of 2 to 5 mm that run all ways.
testing::Height rippled(std::uint64_t seed) {
  struct Wave {
    double x, y, phase, height;
  };
  std::vector<Wave> all;
  Random random(seed);
  for (int k = 0; k < 24; ++k) {
    const double along = random.uniform(0, 2 * kPi);
    const double length_mm = random.uniform(2, 5);
    const double per_mm = 2 * kPi / length_mm;
    all.push_back(
        {per_mm * std::cos(along), per_mm * std::sin(along), random.uniform(0, 2 * kPi), 0.012 * length_mm});
  }
  return [all](double x, double y) {
    double z = -0.01 * (x * x + y * y);
    for (const Wave& wave : all) {
      z += wave.height * std::sin(wave.x * x + wave.y * y + wave.phase);
    }
    return z;
  };
}

/// A scan of part of it, from low_x_mm to high_x_mm.
struct Part {
  RigidTransform field_from_scanner;
  double low_x_mm = 0, high_x_mm = 0;
  std::uint64_t seed = 1;
};

std::shared_ptr<const ScanSurface> scanned(const testing::Height& height, const Part& part) {
  const testing::FieldScan scan{0.4, 0.004, 12, part.low_x_mm, part.high_x_mm, -8, 8, part.seed};
  ScanSurfaceOptions options;
  options.scale_mm = 13;
  return make_scan_surface(testing::scan_field(height, part.field_from_scanner, scan), {}, options);
}

std::optional<PairFit> fitted(const Part& a, const Part& b, const testing::Height& height) {
  const auto on = scanned(height, a);
  const auto moved = scanned(height, b);
  return fit_pair(*on, *moved, a.field_from_scanner.inverse() * b.field_from_scanner,
                  residual_sigma_mm(*on, *moved, {}));
}

/// Samples beyond the border of the other scan were paired with the last ones before it: two scans with 5 mm
/// in common came out 10 um too far apart, each of them.
TEST(PairFit, ScansThatShareAStripAreNotPulledApart) {
  constexpr int kPairs = 12;
  Eigen::Vector3d mean_um = Eigen::Vector3d::Zero();
  for (int k = 0; k < kPairs; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    const Part left{testing::pose_of(5, -4, 3, {0.13 * k, 0.1, 0}), -8, 2.5, 2 * seed};
    const Part right{testing::pose_of(-6, 3, -8, {-0.2, 0.17 * k, 0}), -2.5, 8, 2 * seed + 1};
    const auto fit = fitted(left, right, rippled(seed + 1));
    ASSERT_TRUE(fit && !fit->slid);
    EXPECT_GT(fit->pairs, 700);
    const Eigen::Vector3d strip_mm =
        left.field_from_scanner * (fit->on_from_moved * (right.field_from_scanner.inverse() *
                                                         Eigen::Vector3d(Eigen::Vector3d::Zero())));
    mean_um += 1e3 * strip_mm / kPairs;
  }
  EXPECT_LT(std::abs(mean_um.x()), 3.0);
  EXPECT_LT(std::abs(mean_um.y()), 3.0);
}

/// What tells the covariances that two pairs of a scan see other samples of it.
TEST(PairFit, TellsWhichPartOfEachScanItUsed) {
  const testing::Height height = rippled(3);
  const Part left{testing::pose_of(5, -4, 3, {0, 0.1, 0}), -10, -1, 1};
  const Part middle{testing::pose_of(2, 3, -5, {0.1, 0, 0}), -5, 5, 2};
  const Part right{testing::pose_of(-6, 3, -8, {-0.2, 0, 0}), 1, 10, 3};
  const auto first = fitted(left, middle, height);
  const auto second = fitted(middle, right, height);
  ASSERT_TRUE(first && second);
  EXPECT_NEAR(in_common(first->of_moved, first->of_moved), 1.0, 1e-5);
  EXPECT_LT(in_common(first->of_moved, second->of_on), 0.02) << "the two ends of the middle scan";
  EXPECT_EQ(in_common(first->of_moved, {}), 1.0) << "not known: the worst";
}

}  // namespace
}  // namespace dubsar
