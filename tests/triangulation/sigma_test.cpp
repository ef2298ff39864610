// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Whether a mesh's vertices are as far off as their own sigmas say, on surfaces that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/random.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/normal_noise.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;

Mesh stitched(const test::ScanSet& set) {
  JobContext job;
  Result<Mesh> mesh = stitch(set.placed, {}, job);
  EXPECT_TRUE(mesh.has_value()) << (mesh ? "" : mesh.error().line());
  return mesh ? std::move(*mesh) : Mesh{};
}

/// RMS of error over sigma, of the vertices that `counts`; none counts as more than 10. 1 is right.
double rms_ratio(const Mesh& mesh, const std::function<double(const Vector3f&)>& error_mm,
                 const std::function<bool(std::size_t)>& counts) {
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (counts(v)) {
      const double ratio = error_mm(mesh.positions[v]) / static_cast<double>(mesh.sigma_mm[v]);
      squares += std::min(ratio * ratio, 100.0);
      ++count;
    }
  }
  EXPECT_GT(count, 20U);
  return std::sqrt(squares / static_cast<double>(count));
}

constexpr double kRadius = 6.0;

/// The upper part of a ball, as one scan has it from the way of z.
RangeGrid cap(double spacing_mm, double noise_mm, std::uint64_t seed) {
  Random random(seed);
  const int n = static_cast<int>(1.2 * kRadius / spacing_mm);
  return test::height_grid(n, n, spacing_mm, [&](double x, double y) {
    return std::sqrt(kRadius * kRadius - x * x - y * y) + noise_mm * random.normal();
  });
}

double off_ball(const Vector3f& p) {
  return p.cast<double>().norm() - kRadius;
}

bool is_inner(const Mesh& mesh, std::size_t v) {
  return (mesh.flags[v] & (kVertexSparse | kVertexInterpolated | kVertexBoundary)) == 0;
}

TEST(Sigma, OfALoneScanIsItsNoiseHoweverCoarseItIs) {
  for (const double spacing_mm : {0.05, 0.2, 0.4}) {
    SCOPED_TRACE(spacing_mm);
    test::ScanSet set;
    set.add(cap(spacing_mm, 0.003, 1), {});
    const Mesh mesh = stitched(set);
    const double ratio = rms_ratio(mesh, off_ball, [&](std::size_t v) { return is_inner(mesh, v); });
    EXPECT_GT(ratio, 0.8);
    EXPECT_LT(ratio, 1.25);
  }
}

TEST(Sigma, KnowsHowFarCoarseTrianglesLieBelowARoundSurface) {
  test::ScanSet set;
  for (int k = 0; k < 5; ++k) {
    const double turn = 0.1 * k;
    set.add(cap(0.4, 0.001, static_cast<std::uint64_t>(k) + 1),
            RigidTransform::from_twist({0.5 * turn, -0.3 * turn, 2 * turn}, {0, 0, 0}));
  }
  const Mesh mesh = stitched(set);
  const double ratio =
      rms_ratio(mesh, off_ball, [&](std::size_t v) { return is_inner(mesh, v) && mesh.scans[v] > 2; });
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.25);
}

TEST(Sigma, PosesThatAreToldCountOnce) {
  // In many sets the poses are off by as much as is said of them, noise is small beside it.
  constexpr double kPoseSigmaMm = 0.03;
  double squares = 0;
  constexpr int kSets = 12;
  for (int s = 0; s < kSets; ++s) {
    Random random(static_cast<std::uint64_t>(s) + 5);
    test::ScanSet set;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d off = kPoseSigmaMm / std::sqrt(3.0) * random.normal3();
      set.add(
          cap(0.2, 0.002, random.next()),
          RigidTransform::from_twist({0, 0, 0}, off) * RigidTransform::from_twist({0, 0, 0.3 * k}, {0, 0, 0}),
          kPoseSigmaMm);
    }
    const Mesh mesh = stitched(set);
    const double ratio =
        rms_ratio(mesh, off_ball, [&](std::size_t v) { return is_inner(mesh, v) && mesh.scans[v] == 3; });
    squares += ratio * ratio / kSets;
  }
  EXPECT_GT(std::sqrt(squares), 0.7);
  EXPECT_LT(std::sqrt(squares), 1.3);
}

TEST(Sigma, OfARimSampleThatNoOtherScanSupportsIsItsOwn) {
  // Poses are off by twice the spacing, so that scans fade out towards their rims where they overlap.
  constexpr double kPoseSigmaMm = 0.2;
  test::ScanSet set;
  for (const double side : {0.0, 2.05}) {
    Random random(static_cast<std::uint64_t>(10 * side) + 1);
    set.add(test::height_grid(40, 40, 0.1, [&](double, double) { return 0.005 * random.normal(); }),
            RigidTransform::from_twist({0, 0, 0}, {side, 0.1 * side, 0.1 * side}), kPoseSigmaMm);
  }
  const Mesh mesh = stitched(set);
  std::size_t alone = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (mesh.scans[v] == 1) {
      EXPECT_LT(mesh.sigma_mm[v], kPoseSigmaMm);
      // Where two such poses lie together is known no better than their mean, to 0.08 mm along the normal.
      EXPECT_GT(mesh.sigma_mm[v], 0.25 * kPoseSigmaMm);
      ++alone;
    }
  }
  EXPECT_GT(alone, 800U) << "of 2 x 20 x 40 samples beside the overlap";
}

/// What a scan of µ = 0.05 mm has of such a surface, whose `holes` nobody saw.
test::ScanSet with_holes(const std::function<double(double)>& height,
                         const std::function<bool(double, double)>& holes) {
  Random random(3);
  test::ScanSet set;
  set.add(test::height_grid(80, 80, 0.05,
                            [&](double x, double y) {
                              const double z = height(x) + 0.002 * random.normal();
                              return holes(x, y) ? std::numeric_limits<double>::quiet_NaN() : z;
                            }),
          {});
  return set;
}

TEST(Sigma, OfWhatIsInterpolatedGoesByHowTheClayBendsAroundTheGap) {
  const auto interpolated = [](const Mesh& mesh) {
    return [&](std::size_t v) { return (mesh.flags[v] & kVertexInterpolated) != 0; };
  };
  // A groove, its lower half here and there not seen: there it bends sharply.
  const auto valley = [](double x) { return -std::max(0.0, 0.3 - std::abs(x)); };
  const Mesh sharp = stitched(with_holes(valley, [](double x, double y) {
    return std::abs(x) < 0.06 && std::abs(std::remainder(y, 0.6)) < 0.16;
  }));
  const double of_valley = rms_ratio(
      sharp, [&](const Vector3f& p) { return (p.z() - valley(p.x())) * std::sqrt(0.5); },
      interpolated(sharp));
  EXPECT_GT(of_valley, 0.5);
  EXPECT_LT(of_valley, 1.3);
  // A plate with holes in it is as good there as around them.
  const Mesh flat = stitched(with_holes([](double) { return 0.0; },
                                        [](double x, double y) {
                                          return std::abs(std::remainder(x, 1.0)) < 0.06 &&
                                                 std::abs(std::remainder(y, 1.0)) < 0.16;
                                        }));
  const double of_plate = rms_ratio(
      flat, [](const Vector3f& p) { return static_cast<double>(p.z()); }, interpolated(flat));
  EXPECT_GT(of_plate, 0.1);  // the mean of a dozen has a third of their noise
  EXPECT_LT(of_plate, 1.2);
}

TEST(NormalNoise, IsFoundWhereNeighboursInARowErrTogether) {
  Random random(9);
  constexpr int kSide = 120;
  RangeGrid grid = test::height_grid(kSide, kSide, 0.05, [](double x, double) { return 0.05 * x * x; });
  constexpr double kNoiseMm = 0.01;
  for (int row = 0; row < kSide; ++row) {
    double along = random.normal();
    for (int col = 0; col < kSide; ++col) {
      along = 0.95 * along + std::sqrt(1 - 0.95 * 0.95) * random.normal();
      grid.z[grid.index(row, col)] += static_cast<float>(kNoiseMm * along);
    }
  }
  std::vector<Vector3f> points(grid.size());
  const std::vector<Vector3f> normals(grid.size(), Vector3f(0, 0, 1));
  for (std::size_t i = 0; i < grid.size(); ++i) {
    points[i] = grid.point(i);
  }
  const GridSurface surface{kSide, kSide, 0.05, points, normals, grid.view};
  const std::vector<std::uint8_t> all(grid.size(), 1);
  EXPECT_NEAR(noise_along_normal_mm(surface, all).value_or(0), kNoiseMm, 0.1 * kNoiseMm);
  const std::vector<std::uint8_t> none(grid.size(), 0);
  EXPECT_FALSE(noise_along_normal_mm(surface, none).has_value());
}

}  // namespace
}  // namespace dubsar
