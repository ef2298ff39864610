// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dubsar {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// One pair's part in the pull on the scan that ICP moves.
struct PullTerm {
  Vector6d pull = Vector6d::Zero();  ///< weight · residual · Jacobian of the twist
  Eigen::Vector3d at_mm{0, 0, 0};    ///< from the twist's centre, model frame
  Eigen::Vector3d normal{0, 0, 0};   ///< model frame
  bool crease = false;               ///< of a sample on a crease edge or beside one
  bool used = false;                 ///< false where a sample has no partner
};

/// How far apart the samples and the pairs of a fit lie.
struct PullScale {
  double radius_mm = 1;   ///< rms distance of the pairs from the twist's centre
  double spacing_mm = 1;  ///< of the samples
};

/// What a fit says of its twist.
struct FitInformation {
  Matrix6d information = Matrix6d::Zero();  ///< inverse covariance; zero where there is too little to tell
  int blocks = 0;                           ///< of surface that it was estimated from
};

/// Inverse covariance of a fit at its end: the sandwich of `slope`, the derivative of the total pull by the
/// twist, and the variance of the total pull. Residuals of neighbouring samples are not independent (speckle
/// is correlated along the profile, levels and normals are averages, both scans sample one surface), so that
/// variance is taken from the residuals themselves, summed over what they have in common: the place, in
/// blocks, and the slope and kind of surface, for what a scanner does to every flank that faces one way and
/// to every edge (Huber 1967; Liang and Zeger 1986; two ways at once: Cameron, Gelbach and Miller 2011). What
/// a finite number of blocks leaves uncertain is taken off, and so is what sampling leaves in any fit.
[[nodiscard]] FitInformation fit_information(const Matrix6d& slope, const std::vector<PullTerm>& terms,
                                             const PullScale& scale);

/// The twist -slope⁻¹ · pull, held where next to nothing pulls (`weight`: the sum of the pairs' weights), no
/// point moved by more than about most_mm.
[[nodiscard]] Vector6d held_step(const Matrix6d& slope, const Vector6d& pull, double weight, double radius_mm,
                                 double most_mm);

}  // namespace dubsar
