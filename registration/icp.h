// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/footprint.h"
#include "registration/icp_information.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// A scan that stays where it is while another is moved onto it.
struct IcpTarget {
  const SurfaceLevel* level = nullptr;
  RigidTransform model_from_scanner;
};

enum class IcpMetric {
  kPointToPlane,  ///< once close: symmetric, converges in few steps, slides freely
  kPointToPoint,  ///< when far: the seed's formula, which pulls along the surface too
};

struct IcpOptions {
  IcpMetric metric = IcpMetric::kPointToPlane;
  double reach_mm = 1.0;       ///< pairs farther apart are distant and dropped
  double normal_cosine = 0.7;  ///< pairs whose normals agree less are dropped
  double kernel_mm = 0.1;      ///< scale of the Tukey weight on the residual (its cut-off is 4.7 scales)
  int iterations = 15;
  double converged_mm = 1e-5;  ///< stops when no point of the scan moves farther than this
  bool two_way = false;        ///< also send the targets' samples into the source: symmetric, twice the work
  /// Drops pairs of samples that lie beyond the border of what the other scan matches (lies_on()): they pull
  /// the two apart, by some micrometres. Of a scan that lies far off they may be all there is. For
  /// kPointToPlane.
  bool within_borders = false;
  bool information = false;  ///< also work out IcpResult::information
};

/// The end of an ICP run. The twist convention: left perturbation (omega rad, v mm) of model_from_source
/// about `center_mm` in the model frame.
struct IcpResult {
  RigidTransform model_from_source;
  Eigen::Vector3d center_mm{0, 0, 0};
  int pairs = 0;
  double weight = 0;  ///< sum of the weights of the pairs, robust weights included
  double rms_mm = 0;  ///< weighted, of the point-to-plane residuals
  Matrix6d normal_matrix =
      Matrix6d::Zero();  ///< sum of w J Jᵀ, lengths in mm; divide by the residual's variance
  /// Inverse covariance of the twist (icp_information.h), where asked for and there is enough to tell; zero
  /// otherwise.
  Matrix6d information = Matrix6d::Zero();
  int blocks = 0;                  ///< that the information was estimated from
  Footprint on_source, on_target;  ///< with it, of two ways with one target
  /// Smallest eigenvalue of the normal matrix per unit weight, turns scaled to displacement at the scan's rms
  /// radius: near 0 when the scan can slide on its targets (plane, sphere, cylinder), up to 1/6 or so for a
  /// rugged one.
  double stability = 0;
  Vector6d weakest = Vector6d::Zero();  ///< the direction of that eigenvalue, turns scaled likewise
  bool converged = false;
};

/// Weighted ICP (seed 001, 3.2): pairs by projective lookup in the targets' grids; no boundary samples, no
/// distant pairs, compatible normals; weights from the sample distances times a Tukey weight. Point-to-plane
/// is against the mean of both normals (after Rusinkiewicz 2019), solved by Levenberg-damped Gauss-Newton, so
/// that directions that nothing holds stay where they were; point-to-point is solved in closed form
/// (absolute_orientation.h). The sums of the result are point-to-plane for both. `source` is the level of the
/// moved scan that matches the targets' resolution. Deterministic for any number of threads.
[[nodiscard]] IcpResult icp(const SurfaceLevel& source, std::span<const IcpTarget> targets,
                            const RigidTransform& model_from_source, const IcpOptions& options);

}  // namespace dubsar
