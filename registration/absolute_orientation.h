// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/rigid_transform.h"

namespace dubsar {

/// The rigid transform that takes `source` to `target` with the least weighted sum of squared distances (Horn
/// 1987; seed 001, 3.2): both centroids weighted, the rotation from the eigenvector of the largest eigenvalue
/// of the 4×4 matrix of the weighted cross-covariance. target[i] corresponds to source[i]; weights is empty
/// (all 1) or as long, each >= 0. Nothing when fewer than three pairs have weight, when a value is not
/// finite, or when the points lie on one line (the turn about it is then undetermined).
[[nodiscard]] std::optional<RigidTransform> absolute_orientation(std::span<const Eigen::Vector3d> source,
                                                                 std::span<const Eigen::Vector3d> target,
                                                                 std::span<const double> weights = {});

}  // namespace dubsar
