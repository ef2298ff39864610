// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar {

using NormalTriple = std::array<Eigen::Vector3d, 3>;

/// Triples of directions that unit normals gather about, by spherical 3-means from evenly turned starts: the
/// different ones, cheapest first, each ordered by azimuth about z. Normals farther than 45 degrees from all
/// three count as that far, so that strays pull little. Triples with an empty cluster are left out.
[[nodiscard]] std::vector<NormalTriple> cluster_normals(std::span<const Eigen::Vector3f> normals,
                                                        std::span<const float> weights);

}  // namespace dubsar
