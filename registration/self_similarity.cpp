// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/self_similarity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/units.h"
#include "registration/global_align.h"
#include "registration/relief.h"

namespace dubsar {

namespace {

/// How much of a turned scan must lie on itself to call it similar, and how badly it may fit there.
constexpr double kLeastOverlap = 0.2;
constexpr double kMostDoubt = 2.0;
/// A relief that repeats agrees in a wrong pose as well as with itself; where a pose shows so much more than
/// its repetition, the lines are uneven enough to tell. With 0.5 right poses on lines that are off by 0.2 mm
/// at random were lost; with 0.7 no wrong one came of 19 ruled blanks.
constexpr double kAsWell = 0.7;
constexpr double kMostCorrelation = 0.995;  ///< Fisher's z of more is a matter of sampling

/// How far a scan is moved along itself, of the scale, and in what steps, to see whether its relief repeats.
constexpr double kLeastShift = 0.05;
constexpr double kMostShift = 0.3;
constexpr double kShiftStep = 0.01;

std::vector<Eigen::Vector3d> coarse_points(const ScanSurface& scan) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(scan.coarse->samples.size());
  for (const SurfaceSample& s : scan.coarse->samples) {
    points.emplace_back(s.position_mm.cast<double>());
  }
  return points;
}

Eigen::Matrix3d principal_axes(const std::vector<Eigen::Vector3d>& points_mm, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points_mm) {
    spread += (p - mean) * (p - mean).transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points_mm) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points_mm) {
    mean += p / static_cast<double>(points_mm.size());
  }
  return mean;
}

/// Along each of the two long axes the shift under which the relief agrees best with itself.
std::vector<RigidTransform> likely_shifts(const ScanSurface& scan,
                                          const std::vector<Eigen::Vector3d>& points_mm,
                                          double tolerance_mm) {
  const Eigen::Matrix3d axes = principal_axes(points_mm, mean_of(points_mm));
  const auto steps = static_cast<std::size_t>(std::lround((kMostShift - kLeastShift) / kShiftStep)) + 1;
  std::vector<double> significance(2 * steps);
  const auto shift = [&](std::size_t i) {
    const double by_mm = (kLeastShift + kShiftStep * static_cast<double>(i % steps)) * scan.scale_mm;
    return RigidTransform{Eigen::Matrix3d::Identity(),
                          by_mm * axes.col(2 - static_cast<Eigen::Index>(i / steps))};
  };
  parallel_for_each_index(
      significance.size(),
      [&](std::size_t i) {
        significance[i] =
            relief_agreement(*scan.medium, scan.relief, *scan.medium, scan.relief, shift(i), tolerance_mm)
                .significance(scan.relief.radius_mm);
      },
      1);
  std::vector<RigidTransform> out;
  for (std::size_t first = 0; first < significance.size(); first += steps) {
    const auto begin = significance.begin() + static_cast<std::ptrdiff_t>(first);
    const auto best = std::max_element(begin, begin + static_cast<std::ptrdiff_t>(steps));
    out.push_back(shift(static_cast<std::size_t>(best - significance.begin())));
  }
  return out;
}

}  // namespace

std::vector<RigidTransform> likely_symmetries(const std::vector<Eigen::Vector3d>& points_mm, bool quarters) {
  if (points_mm.empty()) {
    return {};
  }
  const Eigen::Vector3d mean = mean_of(points_mm);
  const Eigen::Matrix3d axes = principal_axes(points_mm, mean);
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
  const ModelScan itself{&scan, {}};
  ModelFitOptions options = fit;
  options.least_significance = 0;
  const std::vector<RigidTransform> turns = likely_symmetries(coarse_points(scan), true);
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

std::vector<ReliefRepeat> find_relief_repeats(const ScanSurface& scan, const ModelFitOptions& fit,
                                              const VerifyOptions& verify) {
  const std::vector<Eigen::Vector3d> points = coarse_points(scan);
  if (points.empty() || scan.relief.cells.empty()) {
    return {};
  }
  std::vector<RigidTransform> starts = likely_symmetries(points, false);
  for (const RigidTransform& shift : likely_shifts(scan, points, fit.coarse_tolerance * scan.scale_mm)) {
    starts.push_back(shift);
  }
  const ModelScan itself{&scan, {}};
  ModelFitOptions options = fit;
  options.least_significance = 0.5 * verify.sure_relief;
  std::vector<ReliefRepeat> out;
  for (std::size_t k = 0; k < starts.size(); k += 2) {  // few at a time, as above
    for (const ModelFit& f : fit_to_model(scan, {&itself, 1}, std::span(starts).subspan(k, 2), options)) {
      const bool unmoved = same_pose(f.model_from_scanner, {}, scan.centroid_mm, options.distinct_turn_rad,
                                     options.distinct_shift * scan.scale_mm);
      if (!unmoved && f.refined() && f.significance >= verify.sure_relief && f.overlap >= kLeastOverlap &&
          doubt(f, verify) <= kMostDoubt) {
        out.push_back({f.model_from_scanner.angle_rad(), f.relief.height, f.relief.tone});
      }
    }
  }
  return out;
}

std::optional<double> repeats_as_well(const std::vector<ReliefRepeat>& repeats, const ReliefAgreement& pose,
                                      const VerifyOptions& verify) {
  const auto as_well = [&](const Correlation& itself, const Correlation& there) {
    return there.value() < verify.sure_correlation ||
           std::atanh(std::min(itself.value(), kMostCorrelation)) >=
               kAsWell * std::atanh(std::min(there.value(), kMostCorrelation));
  };
  for (const ReliefRepeat& repeat : repeats) {
    if (as_well(repeat.height, pose.height) && as_well(repeat.tone, pose.tone)) {
      return repeat.turn_rad;
    }
  }
  return std::nullopt;
}

}  // namespace dubsar
