// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <complex>
#include <vector>

namespace dubsar::sim {

/// The coherent image of a point through a round aperture, sampled on a square grid: amplitudes h with
/// sum |h|² = 1, so that |h|² is the incoherent point spread.
struct PointSpread {
  int radius = 0;                              ///< samples; the grid is (2·radius + 1) squared
  std::vector<std::complex<float>> amplitude;  ///< row major
  [[nodiscard]] int side() const { return 2 * radius + 1; }
  [[nodiscard]] std::complex<float> at(int dx, int dy) const {
    return amplitude[static_cast<std::size_t>((dy + radius) * side() + dx + radius)];
  }
  /// Standard deviation of |h|² along one axis, samples: of the Gaussian that comes nearest.
  [[nodiscard]] double sigma() const;
};

/// resolution_um is wavelength · image-side f-number (the Airy disc's first zero lies at 1.22 times that),
/// defocus_waves the error of the wave front at the aperture's rim (Goodman, Introduction to Fourier Optics,
/// 6.4.4).
[[nodiscard]] PointSpread point_spread(double resolution_um, double sample_um, double defocus_waves);

}  // namespace dubsar::sim
