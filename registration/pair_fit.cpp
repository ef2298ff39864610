// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pair_fit.h"

#include <algorithm>
#include <utility>

namespace dubsar {

std::optional<PairFit> fit_pair(const ScanSurface& on, const ScanSurface& moved,
                                const RigidTransform& on_from_moved, double residual_sigma_mm,
                                const PairFitOptions& options) {
  const IcpTarget target{on.fine.get(), {}};
  IcpOptions icp_options;
  icp_options.two_way = true;
  icp_options.within_borders = true;
  icp_options.information = true;
  icp_options.kernel_mm = 1.5 * residual_sigma_mm;
  icp_options.reach_mm =
      std::max(2.0 * std::max(on.fine->spacing_mm, moved.fine->spacing_mm), 5.0 * residual_sigma_mm);
  icp_options.iterations = 10;
  icp_options.converged_mm = 0.02 * residual_sigma_mm;
  IcpResult result = icp(*moved.fine, {&target, 1}, on_from_moved, icp_options);
  const Eigen::Vector3d slide =
      result.model_from_source * moved.centroid_mm - on_from_moved * moved.centroid_mm;
  PairFit out;
  out.slid = slide.norm() > options.most_slide_sigmas * residual_sigma_mm;
  if (out.slid) {
    // Too loose to tell anything along the slide; at the start's pose it still holds what it can hold.
    icp_options.iterations = 0;
    result = icp(*moved.fine, {&target, 1}, on_from_moved, icp_options);
  }
  if (result.pairs < options.least_pairs || result.information.isZero()) {
    return std::nullopt;
  }
  out.on_from_moved = result.model_from_source;
  out.center_mm = result.center_mm;
  out.information = result.information;
  out.of_on = std::move(result.on_target);
  out.of_moved = std::move(result.on_source);
  out.pairs = result.pairs;
  out.rms_mm = result.rms_mm;
  return out;
}

}  // namespace dubsar
