// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dubsar {

/// The axis along which a scanner saw these points (finite, without an order): one along which they lie one
/// deep, which a scanner's do along its view and seldom along others. The frame's z where it is one of these
/// and does not lie far from the axis along which the points vary least, or that is none; else the middle of
/// those that are. Unit, towards +z (or +y, +x where it lies square to that): nothing in the points tells its
/// ends apart.
[[nodiscard]] Eigen::Vector3d view_axis(const std::vector<Eigen::Vector3f>& points);

}  // namespace dubsar
