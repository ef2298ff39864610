// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dubsar {

/// `count` unit vectors spread evenly over the sphere (Fibonacci lattice), from +z to -z.
[[nodiscard]] std::vector<Eigen::Vector3d> sphere_directions(std::size_t count);

}  // namespace dubsar
