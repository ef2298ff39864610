// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/colour_values.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dubsar {

std::uint8_t colour_byte(double share) {
  return share > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0))) : std::uint8_t{0};
}

bool runs_to_255(double value) {
  constexpr double kBrightest = 1.5;
  return value > kBrightest && std::isfinite(value);
}

std::array<int, 3> PlyColours::properties_of(const PlyElement& vertex) {
  for (const std::string prefix : {"", "diffuse_"}) {
    const std::array<int, 3> three{vertex.scalar(prefix + "red"), vertex.scalar(prefix + "green"),
                                   vertex.scalar(prefix + "blue")};
    if (std::ranges::all_of(three, [](int p) { return p >= 0; })) {
      return three;
    }
  }
  return {-1, -1, -1};
}

PlyColours::PlyColours(const PlyElement& vertex) {
  const std::array<int, 3> property = properties_of(vertex);
  if (property[0] < 0) {
    return;
  }
  property_ = property;
  const PlyType type = vertex.properties[static_cast<std::size_t>(property[0])].type;
  floats_ = type >= PlyType::kFloat32;
  largest_ = floats_ ? 1 : type == PlyType::kUint16 ? 65535 : 255;
  to_largest_.resize(static_cast<std::size_t>(vertex.count));
  to_255_.resize(floats_ ? to_largest_.size() : 0);
}

void PlyColours::put(std::size_t vertex, std::size_t k, double value) {
  to_largest_[vertex][k] = colour_byte(value / largest_);
  if (floats_) {
    to_255_[vertex][k] = colour_byte(value / 255);
    if (runs_to_255(value)) {
      any_runs_to_255_.store(true, std::memory_order_relaxed);
    }
  }
}

std::vector<std::array<std::uint8_t, 3>> PlyColours::take() {
  return std::move(any_runs_to_255_ ? to_255_ : to_largest_);
}

}  // namespace dubsar
