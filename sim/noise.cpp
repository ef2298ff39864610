// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/noise.h"

#include <array>
#include <cmath>

namespace dubsar::sim {

namespace {

double lattice_value(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed) {
  std::uint64_t v = seed ^ (static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL) ^
                    (static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL) ^
                    (static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL);
  v = (v ^ (v >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  v = (v ^ (v >> 27U)) * 0x94d049bb133111ebULL;
  v ^= v >> 31U;
  return static_cast<double>(v >> 11U) * 0x1.0p-52 - 1.0;
}

double fade(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

}  // namespace

double value_noise(const Eigen::Vector3d& p_mm, double wavelength_mm, std::uint64_t seed) {
  const Eigen::Vector3d q = p_mm / wavelength_mm;
  const Eigen::Vector3d base = q.array().floor().matrix();
  const auto x = static_cast<std::int64_t>(base.x());
  const auto y = static_cast<std::int64_t>(base.y());
  const auto z = static_cast<std::int64_t>(base.z());
  const double fx = fade(q.x() - base.x());
  const double fy = fade(q.y() - base.y());
  const double fz = fade(q.z() - base.z());
  std::array<double, 4> along_x{};
  for (int k = 0; k < 4; ++k) {
    const std::int64_t yk = y + (k & 1);
    const std::int64_t zk = z + (k >> 1);
    const double low = lattice_value(x, yk, zk, seed);
    along_x[static_cast<std::size_t>(k)] = low + fx * (lattice_value(x + 1, yk, zk, seed) - low);
  }
  const double near_z = along_x[0] + fy * (along_x[1] - along_x[0]);
  const double far_z = along_x[2] + fy * (along_x[3] - along_x[2]);
  return near_z + fz * (far_z - near_z);
}

double fractal_noise(const Eigen::Vector3d& p_mm, double wavelength_mm, int octaves, std::uint64_t seed) {
  double sum = 0.0;
  double strength = 1.0;
  double total = 0.0;
  for (int k = 0; k < octaves; ++k) {
    sum += strength * value_noise(p_mm, wavelength_mm, seed + static_cast<std::uint64_t>(k) * 7919U);
    total += strength;
    strength *= 0.5;
    wavelength_mm *= 0.5;
  }
  return total > 0.0 ? sum / total : 0.0;
}

}  // namespace dubsar::sim
