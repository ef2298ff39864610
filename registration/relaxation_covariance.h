// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "registration/relaxation.h"

namespace dubsar {

/// The covariance of the same pose's twist about a place that is `off_mm` (model frame) from where it was
/// given.
[[nodiscard]] Matrix6d about_place(const Matrix6d& covariance, const Eigen::Vector3d& off_mm);

/// Fills in the covariances of relaxed poses. Arguments as of relax(); `variance_factor` is how much worse
/// the pairs agree than they claim. The pairs of one scan share the noise of its samples, half of what each
/// pair sees, as far as they use the same part of it (in_common()), so that ten pairs do not make a pose ten
/// times surer, nor a scan between two others bring these nearer than both its pairs do: the sandwich
/// H⁻¹ M H⁻¹ with the covariance M of the pulls. False when it is not finite.
[[nodiscard]] bool set_covariances(std::vector<RelaxedPose>& poses, const std::vector<bool>& held,
                                   const std::vector<Eigen::Vector3d>& centers_mm,
                                   const std::vector<PairConstraint>& pairs, double variance_factor,
                                   double shared_noise);

}  // namespace dubsar
