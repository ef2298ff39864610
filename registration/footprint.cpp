// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/footprint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dubsar {

namespace {

/// Patches along each side: small beside an overlap that holds a scan, few to compare.
constexpr int kPatches = 16;

int patch_along(float share) {
  return std::clamp(static_cast<int>(share * kPatches), 0, kPatches - 1);
}

}  // namespace

Footprint footprint(std::span<const SurfaceSample> samples, std::span<const PullTerm> terms) {
  Footprint out(static_cast<std::size_t>(kPatches) * kPatches, 0.0F);
  float used = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (terms[k].used) {
      out[static_cast<std::size_t>(patch_along(samples[k].row) * kPatches + patch_along(samples[k].col))] +=
          1.0F;
      ++used;
    }
  }
  if (used == 0) {
    return {};
  }
  for (float& share : out) {
    share = std::sqrt(share / used);
  }
  return out;
}

double in_common(const Footprint& a, const Footprint& b) {
  if (a.empty() || b.empty()) {
    return 1.0;
  }
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  }
  return std::min(1.0, sum);
}

}  // namespace dubsar
