// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_laser.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"
#include "core/random.h"

namespace dubsar {

namespace {

/// Total least squares over the points that are marked.
PlaneFit through(const std::vector<Eigen::Vector3d>& points_mm, const std::vector<std::uint8_t>& marked) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (marked[i] != 0) {
      mean += points_mm[i];
      count += 1;
    }
  }
  mean /= std::max(1.0, count);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (marked[i] != 0) {
      scatter += (points_mm[i] - mean) * (points_mm[i] - mean).transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / std::max(1.0, count));
  PlaneFit fit;
  fit.plane.normal = solver.eigenvectors().col(0);
  fit.plane.distance_mm = fit.plane.normal.dot(mean);
  fit.spread_mm = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  fit.rms_mm = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  fit.inlier = marked;
  return fit;
}

/// Enough to choose between candidates: all of them, or of many a part, drawn evenly over all.
std::vector<Eigen::Vector3d> part_of(const std::vector<Eigen::Vector3d>& points_mm) {
  constexpr std::size_t kEnough = 8000;
  if (points_mm.size() <= kEnough) {
    return points_mm;
  }
  Random random(2);
  std::vector<Eigen::Vector3d> out;
  out.reserve(kEnough);
  for (std::size_t k = 0; k < kEnough; ++k) {  // at random: every so many could be one column of a grid
    const std::size_t first = k * points_mm.size() / kEnough;
    const std::size_t next = (k + 1) * points_mm.size() / kEnough;
    out.push_back(points_mm[first + random.below(next - first)]);
  }
  return out;
}

double median_distance(const Plane& plane, const std::vector<Eigen::Vector3d>& points_mm) {
  std::vector<double> distances;
  distances.reserve(points_mm.size());
  for (const Eigen::Vector3d& p : points_mm) {
    distances.push_back(std::abs(plane.signed_distance_mm(p)));
  }
  return median_of(std::move(distances));
}

}  // namespace

std::vector<StripeSample> stripe_samples(const std::vector<CalibrationView>& views,
                                         const Intrinsics& intrinsics, const BoardSpec& board,
                                         double margin_mm, std::size_t most_per_view) {
  std::vector<StripeSample> out;
  const Eigen::Vector2d low = board.low_mm().array() - margin_mm;
  const Eigen::Vector2d high = board.high_mm().array() + margin_mm;
  for (std::size_t k = 0; k < intrinsics.used.size(); ++k) {
    const RigidTransform& pose = intrinsics.camera_from_board[k];
    const Plane face{pose.rotation.col(2), pose.rotation.col(2).dot(pose.translation_mm)};
    std::vector<StripeSample> on_board;
    for (const Eigen::Vector2d& pixel : views[intrinsics.used[k]].stripe_px) {
      const auto ray = intrinsics.camera.undistort(pixel);
      if (!ray) {
        continue;
      }
      const Eigen::Vector3d direction(ray->x(), ray->y(), 1);
      const auto t = face.along(Eigen::Vector3d::Zero(), direction);
      if (!t || !(*t > 0)) {
        continue;
      }
      const Eigen::Vector3d p = *t * direction;
      const Eigen::Vector3d q = pose.inverse() * p;
      if (q.x() > low.x() && q.y() > low.y() && q.x() < high.x() && q.y() < high.y()) {
        on_board.push_back({k, pixel, p});
      }
    }
    const std::size_t take = std::min(most_per_view, on_board.size());
    for (std::size_t i = 0; i < take; ++i) {
      out.push_back(on_board[i * on_board.size() / take]);
    }
  }
  return out;
}

PlaneFit least_squares_plane(const std::vector<Eigen::Vector3d>& points_mm) {
  return through(points_mm, std::vector<std::uint8_t>(points_mm.size(), 1));
}

Result<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points_mm) {
  constexpr std::size_t kLeast = 10;
  if (points_mm.size() < kLeast) {
    return bad_input(
        {},
        "the laser's stripe was seen on the board at " + std::to_string(points_mm.size()) + " points only",
        "take pictures with the laser on the board, bright but not saturated");
  }
  constexpr int kTries = 400;
  const std::vector<Eigen::Vector3d> judges_mm = part_of(points_mm);
  Random random(1);
  Plane best;
  double least = 1e300;
  for (int i = 0; i < kTries; ++i) {
    const Eigen::Vector3d& a = points_mm[random.below(points_mm.size())];
    const Eigen::Vector3d& b = points_mm[random.below(points_mm.size())];
    const Eigen::Vector3d& c = points_mm[random.below(points_mm.size())];
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-3 * (b - a).norm() * (c - a).norm() || !(normal.norm() > 1e-9)) {
      continue;
    }
    const Plane plane{normal.normalized(), normal.normalized().dot(a)};
    const double median = median_distance(plane, judges_mm);
    if (median < least) {
      least = median;
      best = plane;
    }
  }
  if (least >= 1e300) {
    return bad_input({}, "the stripe points all lie on one line",
                     "show the laser on the board at different distances and tilts");
  }
  PlaneFit fit;
  for (int round = 0; round < 5; ++round) {
    const double limit = std::max(1e-6, 3 * kSigmaOfMedian * median_distance(best, points_mm));
    std::vector<std::uint8_t> marked;
    marked.reserve(points_mm.size());
    for (const Eigen::Vector3d& p : points_mm) {
      marked.push_back(std::abs(best.signed_distance_mm(p)) <= limit ? 1 : 0);
    }
    fit = through(points_mm, marked);
    best = fit.plane;
  }
  if (fit.spread_mm < 1.0) {
    return bad_input({}, "the stripe points nearly lie on one line, which leaves the laser plane open",
                     "show the laser on the board at different distances and tilts");
  }
  return fit;
}

}  // namespace dubsar
