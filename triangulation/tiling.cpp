// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/tiling.h"

#include <algorithm>
#include <limits>

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr float kMostPerAxis = 64.0F;  // so that numbers of tiles stay small

}  // namespace

Eigen::AlignedBox3f everywhere() {
  constexpr float kFar = std::numeric_limits<float>::max() / 4;
  return {Vector3f::Constant(-kFar), Vector3f::Constant(kFar)};
}

Tiling::Tiling(const Eigen::AlignedBox3f& box, float edge_mm, float shift)
    : edge_mm_(std::max(edge_mm, box.sizes().maxCoeff() / kMostPerAxis)) {
  if (!(edge_mm_ > 0)) {
    return;
  }
  low_ = box.min() - Vector3f::Constant(shift * edge_mm_);
  for (int k = 0; k < 3; ++k) {
    count_[static_cast<std::size_t>(k)] = static_cast<std::size_t>((box.max()[k] - low_[k]) / edge_mm_) + 1;
  }
}

std::size_t Tiling::tile_of(const Vector3f& p) const {
  if (size() == 1) {
    return 0;
  }
  std::size_t tile = 0;
  for (int k = 2; k >= 0; --k) {
    const std::size_t count = count_[static_cast<std::size_t>(k)];
    const float at = std::clamp((p[k] - low_[k]) / edge_mm_, 0.0F, static_cast<float>(count - 1));
    tile = tile * count + static_cast<std::size_t>(at);
  }
  return tile;
}

Eigen::AlignedBox3f Tiling::box(std::size_t tile) const {
  Eigen::AlignedBox3f out = everywhere();
  if (size() == 1) {
    return out;
  }
  // Its own rounding is far below what lies between work on two tiles.
  for (int k = 0; k < 3; ++k) {
    const std::size_t count = count_[static_cast<std::size_t>(k)];
    const std::size_t at = tile % count;
    tile /= count;
    out.min()[k] = low_[k] + edge_mm_ * static_cast<float>(at);
    out.max()[k] = low_[k] + edge_mm_ * static_cast<float>(at + 1);
  }
  return out;
}

}  // namespace dubsar
