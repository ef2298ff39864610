// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/clay_sphere.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "ui/view/surface_view.h"

namespace dubsar::ui {

namespace {

constexpr int kSize = 256;

}  // namespace

Image clay_sphere() {
  Image image = filled_image(kSize, kSize, {0, 0, 0});
  const Eigen::Vector3f key = Eigen::Vector3f(-0.55F, 0.60F, 0.58F).normalized();
  const Eigen::Vector3f fill = Eigen::Vector3f(0.70F, -0.10F, 0.70F).normalized();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      Eigen::Vector3f n(2 * (static_cast<float>(x) + 0.5F) / kSize - 1,
                        2 * (static_cast<float>(y) + 0.5F) / kSize - 1, 0);
      const float r2 = n.squaredNorm();
      n.z() = std::sqrt(std::max(0.0F, 1 - r2));
      n.normalize();
      // Dry clay is rough: lighter at grazing angles than a matt paint would be (after Oren and Nayar).
      const float wrapped = std::max(0.0F, (n.dot(key) + 0.15F) / 1.15F);
      const float rough = std::pow(wrapped, 0.85F);
      const float soft = 0.22F * std::max(0.0F, n.dot(fill));
      const float sky = 0.12F + 0.06F * n.y();
      const float value = std::clamp(0.80F * rough + soft + sky, 0.0F, 1.0F);
      const std::array<float, 3> tint{value, value * (0.985F + 0.015F * value),
                                      value * (0.96F + 0.04F * value)};
      const std::size_t at = image.offset(x, y);
      for (std::size_t k = 0; k < 3; ++k) {
        image.bytes[at + k] = static_cast<std::uint8_t>(std::lround(255 * tint[k]));
      }
    }
  }
  return image;
}

std::array<std::array<std::uint8_t, 3>, 256> overlay_colours() {
  // Dark blue over teal and green to yellow: brightness grows evenly, so that it reads in grey too.
  constexpr std::array<std::array<float, 3>, 6> kStops{{{0.15F, 0.10F, 0.35F},
                                                        {0.20F, 0.28F, 0.54F},
                                                        {0.13F, 0.47F, 0.56F},
                                                        {0.20F, 0.64F, 0.47F},
                                                        {0.55F, 0.80F, 0.28F},
                                                        {0.99F, 0.91F, 0.25F}}};
  std::array<std::array<std::uint8_t, 3>, 256> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float at = static_cast<float>(i) / 255.0F * (kStops.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
    const float part = at - static_cast<float>(k);
    for (std::size_t c = 0; c < 3; ++c) {
      out[i][c] =
          static_cast<std::uint8_t>(std::lround(255 * (kStops[k][c] * (1 - part) + kStops[k + 1][c] * part)));
    }
  }
  return out;
}

}  // namespace dubsar::ui
