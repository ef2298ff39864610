// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/big_array.h"
#include "core/mesh.h"

namespace dubsar {

/// The surface seen along one direction as heights over the plane across it, mm; −∞ where there is none.
class HeightMap {
 public:
  /// Draws the faces listed, as far as their front is seen. margin_px of nothing on all sides.
  HeightMap(const Mesh& mesh, std::span<const std::uint32_t> faces, const Eigen::Vector3f& direction,
            float pixel_mm, int margin_px);

  /// x and y in pixels (a pixel's middle at whole numbers), z in mm over the plane.
  [[nodiscard]] Eigen::Vector3f place(const Eigen::Vector3f& p_mm) const {
    return {p_mm.dot(u_px_) + offset_u_px_, p_mm.dot(v_px_) + offset_v_px_, p_mm.dot(direction_)};
  }
  /// How much a plane with this normal rises over so many pixels.
  [[nodiscard]] float rise_mm(const Eigen::Vector3f& normal, float dx_px, float dy_px) const {
    const float per_px2 = pixel_mm_ * pixel_mm_ / normal.dot(direction_);
    return -(normal.dot(u_px_) * dx_px + normal.dot(v_px_) * dy_px) * per_px2;
  }
  /// A place at least margin_px inside.
  [[nodiscard]] bool holds(const Eigen::Vector3f& place) const {
    return place.x() >= margin_ && place.y() >= margin_ && place.x() < static_cast<float>(width_) - margin_ &&
           place.y() < static_cast<float>(height_) - margin_;
  }
  [[nodiscard]] const float* row(int y) const {
    return &heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_)];
  }
  [[nodiscard]] std::ptrdiff_t row_step() const { return width_; }

 private:
  void draw(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);

  Eigen::Vector3f direction_;
  Eigen::Vector3f u_px_, v_px_;
  float offset_u_px_ = 0, offset_v_px_ = 0;
  float pixel_mm_ = 1;
  float margin_ = 0;
  int width_ = 0, height_ = 0;
  BigArray<float> heights_;
};

}  // namespace dubsar
