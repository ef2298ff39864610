// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>

namespace dubsar {

/// Space in cubes, so that what lies within one can be worked on beside the others.
class Tiling {
 public:
  /// One tile that holds everything.
  Tiling() = default;
  /// Tiles of an edge of about `edge_mm` over a box, moved by `shift` of an edge against those of shift 0.
  Tiling(const Eigen::AlignedBox3f& box_mm, float edge_mm, float shift);

  [[nodiscard]] std::size_t size() const { return count_[0] * count_[1] * count_[2]; }
  [[nodiscard]] std::size_t tile_of(const Eigen::Vector3f& p_mm) const;
  /// Everything in it is of this tile, and of no other.
  [[nodiscard]] Eigen::AlignedBox3f box(std::size_t tile) const;

 private:
  Eigen::Vector3f low_{0, 0, 0};
  float edge_mm_ = 0;
  std::array<std::size_t, 3> count_{1, 1, 1};
};

/// Whether all that lies within radius_mm of a place lies in the box.
[[nodiscard]] inline bool lies_within(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& p_mm,
                                      float radius_mm) {
  return (p_mm - box.min()).minCoeff() > radius_mm && (box.max() - p_mm).minCoeff() > radius_mm;
}

/// Nothing lies outside of it.
[[nodiscard]] Eigen::AlignedBox3f everywhere();

}  // namespace dubsar
