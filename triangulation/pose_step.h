// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "triangulation/pairing.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

/// A small motion: rotation vector (radians) about a place, then the displacement of that place (mm).
using Motion = Eigen::Matrix<double, 6, 1>;
using MotionMatrix = Eigen::Matrix<double, 6, 6>;

/// How much a motion about `about_mm` moves a surface element at p along its normal n: the row's product with
/// the motion.
[[nodiscard]] Motion motion_row(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& n,
                                const Eigen::Vector3d& about_mm);

/// How the poses of two scans hold their surfaces against each other: the signed distances along the normal
/// over all of the overlap, as one rigid motion explains them best. What is no rigid motion (noise, the rim,
/// other folds of the surface) averages out of it, and slip along the surface moves no distance by itself.
struct PoseStep {
  MotionMatrix information = MotionMatrix::Zero();  ///< Σ w J Jᵀ over the distances
  Motion right = Motion::Zero();                    ///< Σ w J s
  Eigen::Vector3d about_mm{0, 0, 0};                ///< what the motion turns about
  double variance_mm2 = 0;                          ///< of one distance about what the motion explains
  std::size_t count = 0;                            ///< of distances

  /// So many distances say something of poses.
  [[nodiscard]] bool is_known() const;
  /// How far apart along the normal the motion holds the surfaces, RMS over the overlap, mm, its own error
  /// taken out. 0 where that does not stand well above its standard error.
  [[nodiscard]] double step_mm() const;
};

/// From what both have well sampled, seen steeply enough and not at a rim; of a large overlap from some 8000
/// to 16 000 places either way, evenly apart. `there` and `back` are the pairs either way. The motion is that
/// which takes `a` onto `b`.
[[nodiscard]] PoseStep pose_step(const StitchSurface& a, const Pairs& there, const StitchSurface& b,
                                 const Pairs& back);

/// A distance errs with those around it, not alone: so many count as one.
inline constexpr double kDistancesPerIndependent = 4.0;

}  // namespace dubsar
