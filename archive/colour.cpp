// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/colour.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"

namespace dubsar {

namespace {

constexpr int kSteps = 4096;

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {
      t[static_cast<std::size_t>(i)] = static_cast<float>(linear_of_srgb(i / 255.0));
    }
    return t;
  }();
  return table;
}

/// Indexed by the square root of the light, which spreads the dark end.
const std::array<std::uint8_t, kSteps + 1>& srgb_table() {
  static const std::array<std::uint8_t, kSteps + 1> table = [] {
    std::array<std::uint8_t, kSteps + 1> t{};
    for (int i = 0; i <= kSteps; ++i) {
      const double root = static_cast<double>(i) / kSteps;
      t[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255.0 * srgb_of_linear(root * root)));
    }
    return t;
  }();
  return table;
}

}  // namespace

LinearRgb to_linear(Rgb8 colour) {
  const auto& table = linear_table();
  return {table[colour[0]], table[colour[1]], table[colour[2]]};
}

Rgb8 to_srgb(const LinearRgb& colour) {
  const auto& table = srgb_table();
  Rgb8 out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float light = colour[k] > 0 ? std::min(colour[k], 1.0F) : 0.0F;
    out[k] = table[static_cast<std::size_t>(std::sqrt(light) * kSteps + 0.5F)];
  }
  return out;
}

Rgb8 lightness_ramp(double t) {
  static constexpr std::array<Rgb8, 5> kStops = {
      {{16, 38, 86}, {73, 82, 110}, {124, 123, 120}, {181, 168, 108}, {253, 232, 92}}};
  const double at = (t > 0 ? std::min(t, 1.0) : 0.0) * (kStops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const double share = at - static_cast<double>(low);
  Rgb8 out{};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = static_cast<std::uint8_t>(
        std::lround(kStops[low][k] + share * (kStops[low + 1][k] - kStops[low][k])));
  }
  return out;
}

}  // namespace dubsar
