// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/absolute_orientation.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/random.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

std::vector<Eigen::Vector3d> random_points(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3d> out;
  for (int k = 0; k < count; ++k) {
    out.push_back({random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-20, 20)});
  }
  return out;
}

TEST(AbsoluteOrientation, TakesBackAnyMotion) {
  const RigidTransform truth = testing::pose_of(170, -40, 95, {3, -200, 12});
  const std::vector<Eigen::Vector3d> source = random_points(12, 1);
  std::vector<Eigen::Vector3d> target;
  for (const auto& p : source) {
    target.push_back(truth * p);
  }
  const auto found = absolute_orientation(source, target);
  ASSERT_TRUE(found);
  EXPECT_LT((found->rotation - truth.rotation).norm(), 1e-12);
  EXPECT_LT((found->translation_mm - truth.translation_mm).norm(), 1e-10);
}

// Seed 001, 3.2, as it is meant: x -> R(x - C') + C' + T with T = C - C' and both centroids weighted.
TEST(AbsoluteOrientation, IsTheSeedsWeightedFormula) {
  Random random(5);
  const RigidTransform truth = testing::pose_of(10, 20, 30, {1, 2, 3});
  const std::vector<Eigen::Vector3d> source = random_points(30, 2);
  std::vector<Eigen::Vector3d> target;
  std::vector<double> weights;
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  Eigen::Vector3d c_prime = Eigen::Vector3d::Zero();
  double total = 0;
  for (const auto& p : source) {
    target.push_back(truth * p + 0.3 * random.normal3());
    weights.push_back(random.uniform(0.1, 4));
    c += weights.back() * target.back();
    c_prime += weights.back() * p;
    total += weights.back();
  }
  c /= total;
  c_prime /= total;
  const auto found = absolute_orientation(source, target, weights);
  ASSERT_TRUE(found);
  const Eigen::Vector3d t = c - c_prime;
  const Eigen::Vector3d x(4, -7, 9);
  EXPECT_LT((*found * x - (found->rotation * (x - c_prime) + c_prime + t)).norm(), 1e-9);
  // And no small turn or shift makes the weighted error E smaller.
  const auto error = [&](const RigidTransform& pose) {
    double e = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      e += weights[i] * (target[i] - pose * source[i]).squaredNorm();
    }
    return e;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1e-3, 1e-3}) {
      const RigidTransform turn = RigidTransform::from_twist(side * Eigen::Vector3d::Unit(axis), {0, 0, 0});
      const RigidTransform shift{Eigen::Matrix3d::Identity(), side * Eigen::Vector3d::Unit(axis)};
      EXPECT_GT(error(turn * *found), error(*found));
      EXPECT_GT(error(shift * *found), error(*found));
    }
  }
}

TEST(AbsoluteOrientation, WeightZeroTakesAPairOut) {
  std::vector<Eigen::Vector3d> source = random_points(5, 3);
  std::vector<Eigen::Vector3d> target = source;
  target[4] += Eigen::Vector3d(100, 0, 0);
  const std::vector<double> weights{1, 1, 1, 1, 0};
  const auto found = absolute_orientation(source, target, weights);
  ASSERT_TRUE(found);
  EXPECT_LT(found->translation_mm.norm(), 1e-9);
}

TEST(AbsoluteOrientation, RefusesWhatDoesNotSettleAPose) {
  const std::vector<Eigen::Vector3d> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
  EXPECT_FALSE(absolute_orientation(line, line));
  const std::vector<Eigen::Vector3d> two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(absolute_orientation(two, two));
  std::vector<Eigen::Vector3d> bad = random_points(5, 4);
  bad[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(absolute_orientation(bad, bad));
  EXPECT_FALSE(absolute_orientation(bad, two));
}

}  // namespace
}  // namespace dubsar
