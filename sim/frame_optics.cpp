// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/frame_optics.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar::sim {

namespace {

/// Integral over the pupil's radius of exp(i 2π W ρ²) J0(π r ρ / (λN')) ρ dρ, midpoint rule.
std::complex<double> amplitude_at(double r_um, double resolution_um, double waves) {
  constexpr int kSteps = 200;
  std::complex<double> sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double rho = (i + 0.5) / kSteps;
    // J0 falls below zero, where std::polar() would have no meaning.
    sum += rho * std::cyl_bessel_j(0.0, kPi * r_um * rho / resolution_um) *
           std::polar(1.0, 2 * kPi * waves * rho * rho);
  }
  return sum / static_cast<double>(kSteps);
}

}  // namespace

double PointSpread::sigma() const {
  // The second moment of an Airy pattern has no limit; the half width has.
  const double half = std::norm(at(0, 0)) / 2;
  for (int dx = 1; dx <= radius; ++dx) {
    const double here = std::norm(at(dx, 0));
    if (here <= half) {
      const double before = std::norm(at(dx - 1, 0));
      const double half_width = dx - 1 + (before - half) / (before - here);
      return half_width / 1.1774;  // sqrt(2 ln 2)
    }
  }
  return radius;
}

PointSpread point_spread(double resolution_um, double sample_um, double defocus_waves) {
  // To the third dark ring of the Airy pattern, which holds 94 % of the light; wider out of focus, where the
  // blur's rim is 8·waves·λN' away.
  const double reach_um = (3.24 + 8 * std::abs(defocus_waves)) * resolution_um;
  PointSpread out;
  out.radius = std::max(1, static_cast<int>(std::ceil(reach_um / sample_um)));
  // Along the radius it is smooth: 64 values for each λN' are plenty, and Bessel functions are slow.
  constexpr double kPerResolution = 64;
  std::vector<std::complex<double>> radial;
  for (int i = 0; i <= static_cast<int>(reach_um / resolution_um * kPerResolution) + 2; ++i) {
    radial.push_back(amplitude_at(i * resolution_um / kPerResolution, resolution_um, defocus_waves));
  }
  const auto amplitude = [&](double r_um) {
    const double at = r_um / resolution_um * kPerResolution;
    const auto i = static_cast<std::size_t>(at);
    const double t = at - static_cast<double>(i);
    return (1 - t) * radial[i] + t * radial[i + 1];
  };
  double energy = 0;
  std::vector<std::complex<double>> grid;
  for (int dy = -out.radius; dy <= out.radius; ++dy) {
    for (int dx = -out.radius; dx <= out.radius; ++dx) {
      const double r_um = sample_um * std::hypot(dx, dy);
      const bool inside = r_um <= reach_um;
      grid.push_back(inside ? amplitude(r_um) : 0);
      energy += std::norm(grid.back());
    }
  }
  for (const std::complex<double>& h : grid) {
    out.amplitude.emplace_back(h / std::sqrt(energy));
  }
  return out;
}

}  // namespace dubsar::sim
