// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "registration/pin_detection.h"
#include "registration/pin_matching.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

/// A flat slab with pins above it: vertical balls on cones that lie in the plane y = tip.y and rise along +x.
RangeGrid slab_with_pins(const std::vector<Eigen::Vector3d>& tips, double radius_mm, double noise_mm) {
  RangeGrid grid;
  grid.allocate(300, 400);
  grid.spacing_mm = 0.1;
  Random random(4);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const double x = -20 + 0.1 * col;
      const double y = -15 + 0.1 * row;
      double z = std::abs(x) < 15 && std::abs(y) < 12 ? 0.0 : -1000.0;
      for (const Eigen::Vector3d& tip : tips) {
        const double dx = x - tip.x();
        const double dy = y - tip.y();
        if (dx * dx + dy * dy < radius_mm * radius_mm) {
          z = std::max(z, tip.z() + std::sqrt(radius_mm * radius_mm - dx * dx - dy * dy));
        }
        const double arm = 0.6 * radius_mm + 0.04 * dx;  // half width of the cone
        if (dx > 0 && dx < 6 && std::abs(dy) < arm) {
          z = std::max(z, tip.z() + std::sqrt(arm * arm - dy * dy));
        }
      }
      if (z > -500) {
        const std::size_t i = grid.index(row, col);
        grid.x[i] = static_cast<float>(x);
        grid.y[i] = static_cast<float>(y);
        grid.z[i] = static_cast<float>(z + noise_mm * random.normal());
        grid.valid[i] = 1;
      }
    }
  }
  return grid;
}

TEST(PinDetection, FindsTipsAndMasksPinsOnly) {
  const std::vector<Eigen::Vector3d> tips{{-8, -5, 3}, {2, 4, 4}, {-3, 9, 2.5}};
  const RangeGrid grid = slab_with_pins(tips, 0.6, 0.01);
  const PinDetection found = detect_pins(grid, 1.2, {});
  ASSERT_EQ(found.tips.size(), tips.size());
  for (const Eigen::Vector3d& tip : tips) {
    double nearest = 1e9;
    for (const PinTip& t : found.tips) {
      nearest = std::min(nearest, (t.position_mm - tip).norm());
    }
    EXPECT_LT(nearest, 0.05);
  }
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool pin = grid.valid[i] != 0 && grid.z[i] > 0.5F;
    wrong += pin != (found.mask[i] != 0) ? 1U : 0U;
  }
  EXPECT_LE(wrong, 5U);
}

TEST(PinDetection, FindsNothingOnClay) {
  const RangeGrid grid = testing::scan_field(testing::bumpy(3), {}, {});
  const PinDetection found = detect_pins(grid, 1.5, {});
  EXPECT_TRUE(found.tips.empty());
  EXPECT_EQ(std::count(found.mask.begin(), found.mask.end(), std::uint8_t{1}), 0);
  EXPECT_TRUE(detect_pins(RangeGrid{}, 1.0, {}).tips.empty());
}

std::vector<PinTip> rim_pins() {
  std::vector<PinTip> tips;
  Random random(8);
  for (int k = 0; k < 15; ++k) {
    const double a = 2 * 3.14159265 * k / 15;
    tips.push_back({k, {30 * std::cos(a), 22 * std::sin(a), random.uniform(-9, 9)}});
  }
  return tips;
}

/// Put back with an error, seen from elsewhere, `kept` of them.
std::vector<PinTip> put_back(const std::vector<PinTip>& tips, const RigidTransform& pose, std::size_t first,
                             std::size_t kept, std::uint64_t seed, bool labels) {
  Random random(seed);
  std::vector<PinTip> out;
  for (std::size_t k = 0; k < kept; ++k) {
    PinTip tip = tips[(first + k) % tips.size()];
    tip.position_mm = pose.inverse() * Eigen::Vector3d(tip.position_mm +
                                                       0.3 * Eigen::Vector3d(random.normal(), random.normal(),
                                                                             random.normal()));
    if (!labels) {
      tip.label = -1;
    }
    out.push_back(tip);
  }
  return out;
}

TEST(PinMatching, FindsThePoseFromLabelsDespiteAMislabelledPin) {
  const RigidTransform pose = testing::pose_of(150, 20, -60, {5, 6, 7});
  std::vector<PinTip> source = put_back(rim_pins(), pose, 0, 9, 1, true);
  std::swap(source[0].label, source[4].label);
  const auto match = match_pins(source, put_back(rim_pins(), {}, 2, 9, 2, true), {});
  ASSERT_TRUE(match);
  EXPECT_LT(
      (RigidTransform{match->target_from_source.rotation * pose.rotation.transpose(), {0, 0, 0}}.angle_rad()),
      0.05);
}

TEST(PinMatching, FindsThePoseFromDistancesWithHalfMissing) {
  int right = 0;
  int wrong = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RigidTransform pose = testing::pose_of(100, 20 + static_cast<double>(seed), -60, {5, 6, 7});
    const auto match = match_pins(put_back(rim_pins(), pose, 0, 10, seed, false),
                                  put_back(rim_pins(), {}, 3, 10, seed + 50, false), {});
    if (match) {
      const RigidTransform turn{match->target_from_source.rotation * pose.rotation.transpose(), {0, 0, 0}};
      (turn.angle_rad() < 0.08 ? right : wrong) += 1;
    }
  }
  EXPECT_GE(right, 18);
  EXPECT_LE(wrong, 1);
}

TEST(PinMatching, RefusesTooFewOrAmbiguous) {
  EXPECT_FALSE(match_pins({}, {}, {}));
  const std::vector<PinTip> square{{-1, {0, 0, 0}}, {-1, {20, 0, 0}}, {-1, {20, 20, 0}}, {-1, {0, 20, 0}}};
  EXPECT_FALSE(match_pins(square, square, {}));
}

}  // namespace
}  // namespace dubsar
