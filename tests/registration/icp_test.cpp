// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/icp.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/SVD>
#include <cmath>

#include "core/units.h"
#include "registration/model_fit.h"
#include "registration/pair_fit.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

struct Pair {
  RangeGrid grid_a, grid_b;
  std::shared_ptr<const ScanSurface> a, b;
  RigidTransform a_from_b;
};

/// Two views of one bumpy field; the second sees a square of 2 half_b_mm of it.
Pair two_views(std::uint64_t seed, double spacing_mm, double noise_mm, double half_b_mm = 25) {
  const testing::Height height = testing::bumpy(seed);
  const RigidTransform model_from_a = testing::pose_of(8, -6, 3, {1, 0, 0});
  const RigidTransform model_from_b = testing::pose_of(-9, 7, 20, {-2, 3, 1});
  testing::FieldScan scan;
  scan.spacing_mm = spacing_mm;
  scan.noise_mm = noise_mm;
  Pair pair;
  scan.seed = 2 * seed;
  pair.grid_a = testing::scan_field(height, model_from_a, scan);
  scan.seed = 2 * seed + 1;
  scan.low_x_mm = scan.low_y_mm = -half_b_mm;
  scan.high_x_mm = scan.high_y_mm = half_b_mm;
  pair.grid_b = testing::scan_field(height, model_from_b, scan);
  ScanSurfaceOptions options;
  options.scale_mm = surface_scale_mm(pair.grid_a);
  pair.a = make_scan_surface(pair.grid_a, {}, options);
  pair.b = make_scan_surface(pair.grid_b, {}, options);
  pair.a_from_b = model_from_a.inverse() * model_from_b;
  return pair;
}

/// The pose, off by a turn about the moved scan's centroid and a shift.
RigidTransform off(const Pair& pair, const Eigen::Vector3d& omega_rad, const Eigen::Vector3d& shift_mm) {
  const RigidTransform turn = RigidTransform::from_twist(omega_rad, {0, 0, 0});
  const Eigen::Vector3d center = pair.a_from_b * pair.b->centroid_mm;
  return {turn.rotation * pair.a_from_b.rotation,
          turn.rotation * (pair.a_from_b.translation_mm - center) + center + shift_mm};
}

/// Seed 001, 3.2: w[i] = Average{1/d_ik} over the neighbours k of the sample, in parts of the mean over the
/// scan.
TEST(Icp, SampleWeightsAreMeanReciprocalDistances) {
  const Pair pair = two_views(3, 0.5, 0.01);
  const SurfaceLevel& level = *pair.b->fine;
  const RangeGrid& grid = level.grid;
  const auto closeness = [&](std::size_t i) {
    double sum = 0;
    for (const std::size_t k :
         {i - 1, i + 1, i - static_cast<std::size_t>(grid.cols), i + static_cast<std::size_t>(grid.cols)}) {
      EXPECT_TRUE(grid.valid[k]) << "a boundary sample takes part";
      sum += 1.0 / static_cast<double>((grid.point(k) - grid.point(i)).norm());
    }
    return sum / 4.0;
  };
  double mean = 0;
  double count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (level.usable[i] != 0) {
      mean += closeness(i);
      ++count;
    }
  }
  mean /= count;
  ASSERT_GT(level.samples.size(), 1000U);
  double least = 10;
  double most = 0;
  for (const SurfaceSample& sample : level.samples) {
    const std::int64_t i = level.lookup->nearest(sample.position_mm, 1e-4F);
    ASSERT_GE(i, 0);
    EXPECT_NEAR(static_cast<double>(sample.weight), closeness(static_cast<std::size_t>(i)) / mean, 1e-4);
    least = std::min(least, static_cast<double>(sample.weight));
    most = std::max(most, static_cast<double>(sample.weight));
  }
  EXPECT_GT(most / least, 1.1) << "a field with slopes has samples near and far";
}

/// One step of point-to-point ICP against the seed's formula worked out here: pairs by brute force, the
/// weights w = average(1/d_ik), x -> R(x - C') + C' + T with T = C - C', R from the weighted cross-covariance
/// (by its singular values).
TEST(Icp, PointToPointStepIsTheSeedsWeightedFormula) {
  const Pair pair = two_views(4, 1.0, 0.02, 15);  // all of b lies on a: no sample meets a border
  const RigidTransform start = off(pair, {0.01, -0.02, 0.03}, {0.3, -0.2, 0.25});
  IcpOptions options;
  options.metric = IcpMetric::kPointToPoint;
  options.reach_mm = 3.0;
  options.normal_cosine = 0.7;
  options.kernel_mm = 1e6;  // plain: no robust weight
  options.iterations = 1;
  const IcpTarget target{pair.a->fine.get(), {}};
  const IcpResult result = icp(*pair.b->fine, {&target, 1}, start, options);

  const SurfaceLevel& into = *pair.a->fine;
  std::vector<Eigen::Vector3d> moved;
  std::vector<Eigen::Vector3d> still;
  std::vector<double> weights;
  for (const SurfaceSample& sample : pair.b->fine->samples) {
    const Eigen::Vector3d p = start * Eigen::Vector3d(sample.position_mm.cast<double>());
    std::size_t best = 0;
    double best_mm = 1e9;
    for (std::size_t j = 0; j < into.grid.size(); ++j) {
      const double d = (into.grid.point(j).cast<double>() - p).norm();
      if (into.usable[j] != 0 && d < best_mm) {
        best_mm = d;
        best = j;
      }
    }
    const Eigen::Vector3d n = start.rotation * Eigen::Vector3d(sample.normal.cast<double>());
    if (best_mm <= options.reach_mm && n.dot(into.normals[best].cast<double>()) >= options.normal_cosine) {
      moved.push_back(p);
      still.emplace_back(into.grid.point(best).cast<double>());
      weights.push_back(static_cast<double>(sample.weight));
    }
  }
  double total = 0;
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  Eigen::Vector3d c_prime = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    total += weights[i];
    c += weights[i] * still[i];
    c_prime += weights[i] * moved[i];
  }
  c /= total;
  c_prime /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    covariance += weights[i] * (moved[i] - c_prime) * (still[i] - c).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixV() * svd.matrixU().transpose()).determinant());
  const Eigen::Matrix3d r = svd.matrixV() * sign.asDiagonal() * svd.matrixU().transpose();
  const Eigen::Vector3d t = c - c_prime;
  ASSERT_GT(moved.size(), 300U);
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, 10, 2), Eigen::Vector3d(-15, 18, -1)}) {
    const Eigen::Vector3d seed = r * (x - c_prime) + c_prime + t;
    const Eigen::Vector3d ours = result.model_from_source * (start.inverse() * x);
    EXPECT_GT((seed - x).norm(), 0.05) << "the step is no small one";
    EXPECT_LT((ours - seed).norm(), 1e-4);
  }
}

TEST(Icp, BothMetricsFindThePose) {
  const Pair pair = two_views(5, 0.5, 0.01);
  const IcpTarget medium{pair.a->medium.get(), {}};
  const IcpTarget fine{pair.a->fine.get(), {}};
  const RigidTransform start = off(pair, {0.05, -0.06, 0.05}, {1.5, -1.2, 1.0});
  IcpOptions far;
  far.metric = IcpMetric::kPointToPoint;
  far.reach_mm = 6.0;
  far.kernel_mm = 2.0;
  far.iterations = 30;
  const IcpResult near = icp(*pair.b->medium, {&medium, 1}, start, far);
  EXPECT_GT(near.pairs, 100);
  IcpOptions close;
  close.reach_mm = 1.5;
  close.kernel_mm = 0.2;
  const IcpResult there = icp(*pair.b->fine, {&fine, 1}, near.model_from_source, close);
  EXPECT_TRUE(there.converged);
  EXPECT_LT((there.model_from_source * pair.b->centroid_mm - pair.a_from_b * pair.b->centroid_mm).norm(),
            0.02);
  EXPECT_LT(deg_from_rad(RigidTransform{
                there.model_from_source.rotation * pair.a_from_b.rotation.transpose(),
                {0, 0, 0}}.angle_rad()),
            0.05);
}

/// The covariance of a pair is what it says: the normalised squared error over pairs of scans with different
/// noise and spacing is about one per degree of freedom.
TEST(Icp, InformationIsCalibrated) {
  double sum = 0;
  int fits = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Pair pair = two_views(seed, seed % 2 == 0 ? 0.3 : 0.4, seed % 3 == 0 ? 0.03 : 0.1);
    const double sigma_mm = residual_sigma_mm(*pair.a, *pair.b, {});
    const RigidTransform start = off(pair, {1e-3, -1e-3, 5e-4}, {0.02, -0.02, 0.01});
    const auto fit = fit_pair(*pair.a, *pair.b, start, sigma_mm);
    ASSERT_TRUE(fit);
    ASSERT_FALSE(fit->slid);
    const RigidTransform away = fit->on_from_moved * pair.a_from_b.inverse();
    const Eigen::Vector3d center = pair.a_from_b * (fit->on_from_moved.inverse() * fit->center_mm);
    const Eigen::AngleAxisd turn(away.rotation);
    Vector6d error;
    error << turn.angle() * turn.axis(), away * center - center;
    const double square = error.dot(fit->information * error) / 6.0;
    EXPECT_LT(square, 8.0) << "seed " << seed;
    sum += square;
    ++fits;
  }
  EXPECT_GT(sum / fits, 0.5);
  EXPECT_LT(sum / fits, 1.6);
}

TEST(Icp, SameBytesForAnyNumberOfThreads) {
  const Pair pair = two_views(6, 0.5, 0.02);
  const RigidTransform start = off(pair, {2e-3, -2e-3, 2e-3}, {0.1, -0.1, 0.05});
  const auto run = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return fit_pair(*pair.a, *pair.b, start, 0.1);
  };
  const auto one = run(1);
  const auto many = run(4);
  ASSERT_TRUE(one && many);
  EXPECT_EQ(one->on_from_moved.rotation, many->on_from_moved.rotation);
  EXPECT_EQ(one->on_from_moved.translation_mm, many->on_from_moved.translation_mm);
  EXPECT_EQ(one->information, many->information);
}

TEST(Icp, NothingInReachLeavesThePose) {
  const Pair pair = two_views(7, 0.5, 0.01);
  const RigidTransform far = off(pair, {0, 0, 0}, {500, 0, 0});
  const IcpTarget target{pair.a->fine.get(), {}};
  for (const IcpMetric metric : {IcpMetric::kPointToPlane, IcpMetric::kPointToPoint}) {
    IcpOptions options;
    options.metric = metric;
    options.information = true;
    const IcpResult result = icp(*pair.b->fine, {&target, 1}, far, options);
    EXPECT_EQ(result.pairs, 0);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.model_from_source.translation_mm, far.translation_mm);
    EXPECT_TRUE(result.information.isZero());
  }
  EXPECT_FALSE(fit_pair(*pair.a, *pair.b, far, 0.05));
}

}  // namespace
}  // namespace dubsar
