// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/sphere_directions.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar {

std::vector<Eigen::Vector3d> sphere_directions(std::size_t count) {
  std::vector<Eigen::Vector3d> out(count);
  const double golden_rad = kPi * (3.0 - std::sqrt(5.0));
  for (std::size_t k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(count);
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double phi = golden_rad * static_cast<double>(k);
    out[k] = {r * std::cos(phi), r * std::sin(phi), z};
  }
  return out;
}

}  // namespace dubsar
