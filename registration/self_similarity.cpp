// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/self_similarity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/units.h"
#include "registration/global_align.h"

namespace dubsar {

namespace {

/// How much of a turned scan must lie on itself to call it similar, and how badly it may fit there.
constexpr double kLeastOverlap = 0.2;
constexpr double kMostDoubt = 2.0;

}  // namespace

std::vector<RigidTransform> likely_symmetries(const std::vector<Eigen::Vector3d>& points_mm, bool quarters) {
  if (points_mm.empty()) {
    return {};
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points_mm) {
    mean += p / static_cast<double>(points_mm.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points_mm) {
    spread += (p - mean) * (p - mean).transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& p : points_mm) {
    const Eigen::Vector3d q = axes.transpose() * p;
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  // Not only the mean: what was scanned often lies on one side.
  const Eigen::Vector3d middle = axes * (0.5 * (low + high));
  std::vector<RigidTransform> out;
  for (const double angle :
       quarters ? std::vector<double>{kPi, 0.5 * kPi, -0.5 * kPi} : std::vector<double>{kPi}) {
    for (int k = 0; k < 3; ++k) {
      for (const Eigen::Vector3d& through : {middle, mean}) {
        const Eigen::Matrix3d r = Eigen::AngleAxisd(angle, axes.col(k)).toRotationMatrix();
        out.push_back({r, through - r * through});
      }
    }
  }
  return out;
}

bool self_similar(const ScanSurface& scan, const ModelFitOptions& fit, const VerifyOptions& verify) {
  std::vector<Eigen::Vector3d> points;
  for (const SurfaceSample& s : scan.coarse->samples) {
    points.emplace_back(s.position_mm.cast<double>());
  }
  const ModelScan itself{&scan, {}};
  ModelFitOptions options = fit;
  options.least_significance = 0;
  const std::vector<RigidTransform> turns = likely_symmetries(points, true);
  // Few at a time: the fit refines only the best starts of a batch.
  for (std::size_t k = 0; k < turns.size(); k += 2) {
    for (const ModelFit& f : fit_to_model(scan, {&itself, 1}, std::span(turns).subspan(k, 2), options)) {
      const bool unturned = same_pose(f.model_from_scanner, {}, scan.centroid_mm, options.distinct_turn_rad,
                                      options.distinct_shift * scan.scale_mm);
      if (!unturned && f.overlap >= kLeastOverlap && doubt(f, verify) <= kMostDoubt) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace dubsar
