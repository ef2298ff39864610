// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "registration/icp.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What two scans that lie about right say of their relative pose: the measurement that relaxation weighs.
/// The twist convention of IcpResult, in the frame of the scan that stays.
struct PairFit {
  RigidTransform on_from_moved;
  Eigen::Vector3d center_mm{0, 0, 0};
  Matrix6d information = Matrix6d::Zero();
  Footprint of_on, of_moved;
  int pairs = 0;
  double rms_mm = 0;
  bool slid = false;  ///< the surfaces let the scan slide away: the pose is the start's
};

struct PairFitOptions {
  int least_pairs = 150;           ///< fewer say too little to be worth their risk
  double most_slide_sigmas = 6.0;  ///< a fit that leaves the start by more residual sigmas has slid away
};

/// Measures the pose of `moved` on `on` at full resolution, both ways, from a start that is right to a few
/// residual_sigma_mm (the expected standard deviation of a residual, model_fit.h). Nothing when the scans
/// share too little.
[[nodiscard]] std::optional<PairFit> fit_pair(const ScanSurface& on, const ScanSurface& moved,
                                              const RigidTransform& on_from_moved, double residual_sigma_mm,
                                              const PairFitOptions& options = {});

}  // namespace dubsar
