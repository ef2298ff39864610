// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/plane_refit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"

namespace dubsar {

namespace {

/// Feet move with the planes: so many times.
constexpr int kRounds = 4;
/// From so many spacings off the creases on a vertex counts in full. Stitched without noise at µ 0.1 mm,
/// simulated clay stands 5 µm too high beside the creases, 2 µm a spacing away, and rightly from two on.
constexpr double kClearSpacings = 1.0;
/// What it counts at the crease itself: a face of a few rows of vertices has no others.
constexpr double kLeastShare = 0.05;
/// Tukey's weight falls to nothing at so many tolerances; nearer, it would cut the noise lopsidedly where
/// planes still lie askew.
constexpr double kTukeyTolerances = 2.25;
/// Vertices of no face are of the rim at most so far below it, in shares of the rim's own depth.
constexpr double kRimBand = 2.0;
constexpr std::uint32_t kFewest = 4;
constexpr double kFarTurned = 0.95;  // cosine of 18 degrees

struct Sums {
  double weight = 0, weight_squares = 0, off_squares = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  std::uint32_t count = 0;

  void add(const Eigen::Vector3d& p, double off_mm, double w) {
    weight += w;
    weight_squares += w * w;
    off_squares += w * off_mm * off_mm;
    mean += w * p;
    moment += w * p * p.transpose();
    ++count;
  }
};

/// How far the foot of p on face k lies from the nearest crease, in the plane; below zero beyond it.
double to_crease_mm(const WedgeFaces& faces, std::size_t k, const Eigen::Vector3d& p, double off_mm) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::size_t j : {(k + 1) % 3, (k + 2) % 3}) {
    const double cosine = faces.plane[k].normal.dot(faces.plane[j].normal);
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 1e-4));
    nearest = std::min(nearest, (faces.plane[j].distance(p) - cosine * off_mm) / sine);
  }
  return nearest;
}

/// The plane of these; `before` where they give none.
FacePlane plane_of(const Sums& sums, const FacePlane& before) {
  if (sums.count < kFewest || !(sums.weight > 0)) {
    return before;
  }
  const Eigen::Vector3d mean = sums.mean / sums.weight;
  const Eigen::Matrix3d covariance = sums.moment / sums.weight - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(before.normal) < 0) {
    normal = -normal;
  }
  if (solver.eigenvalues()(1) < 1e-8 || normal.dot(before.normal) < kFarTurned) {
    return before;
  }
  FacePlane out = before;
  out.normal = normal;
  out.offset_mm = normal.dot(mean);
  out.middle = mean;
  out.rms_mm = std::sqrt(sums.off_squares / sums.weight);
  // Of so many vertices of equal weight.
  const double independent = sums.weight * sums.weight / sums.weight_squares;
  out.sigma_rad = out.rms_mm / std::sqrt(solver.eigenvalues()(1) * independent);
  return out;
}

}  // namespace

WedgeFaces refit_planes(const WedgePatch& patch, WedgeFaces faces, double tolerance_mm, double rim_mm,
                        double normal_gate_deg) {
  const double gate = std::cos(rad_from_deg(normal_gate_deg));
  const double clear_mm = kClearSpacings * patch.spacing_mm;
  for (int round = 0; round < kRounds; ++round) {
    std::array<Sums, 3> sums;
    for (std::size_t v = 0; v < patch.size(); ++v) {
      const Eigen::Vector3d p = patch.p[v].cast<double>();
      const Eigen::Vector3d n = patch.n[v].cast<double>();
      const bool at_rim = faces.face[v] < 0 && patch.height[v] > kRimBand * rim_mm;
      for (std::size_t k = 0; k < 3; ++k) {
        const FacePlane& plane = faces.plane[k];
        // Of no face for its height alone, it may be of any.
        if (faces.face[v] != static_cast<std::int8_t>(k) && !(at_rim && n.dot(plane.normal) > gate)) {
          continue;
        }
        const double off = plane.distance(p);
        const double u = off / (kTukeyTolerances * tolerance_mm);
        const double crease = to_crease_mm(faces, k, p, off);
        if (std::abs(u) >= 1 || crease <= 0 || patch.height[v] - off * plane.normal.z() > rim_mm) {
          continue;
        }
        const double clear = std::clamp(crease / clear_mm, kLeastShare, 1.0);
        const double tukey = (1 - u * u) * (1 - u * u);
        sums[k].add(p, off, clear * tukey * patch.area[v] * fit_weight(patch.weight[v]));
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      faces.plane[k] = plane_of(sums[k], faces.plane[k]);
    }
  }
  return faces;
}

}  // namespace dubsar
