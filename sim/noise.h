// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace dubsar::sim {

/// Smooth value noise at p / wavelength_mm: about in [-1, 1], zero mean, the same everywhere for one seed.
[[nodiscard]] double value_noise(const Eigen::Vector3d& p_mm, double wavelength_mm, std::uint64_t seed);

/// Octaves of value_noise, each at half the wavelength and half the strength; scaled to about [-1, 1].
[[nodiscard]] double fractal_noise(const Eigen::Vector3d& p_mm, double wavelength_mm, int octaves,
                                   std::uint64_t seed);

}  // namespace dubsar::sim
