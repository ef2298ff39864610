// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace dubsar {

/// Three directions that unit normals gather about, by spherical 3-means from evenly turned starts, the best
/// kept; ordered by azimuth about z. Normals farther than 45 degrees from all three count as that far, so that
/// strays pull little. Nothing when one of them stays empty.
[[nodiscard]] std::optional<std::array<Eigen::Vector3d, 3>> cluster_normals(
    std::span<const Eigen::Vector3f> normals, std::span<const float> weights);

}  // namespace dubsar
