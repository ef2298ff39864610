// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/big_array.h"
#include "core/mesh.h"

namespace dubsar {

/// How a mesh is drawn into orthographic depth maps.
struct DepthMapPlan {
  Eigen::Vector3f centre_mm{0, 0, 0};
  float pixel_mm = 1;
  int side_px = 0;                         ///< maps are square
  std::vector<std::uint32_t> large_faces;  ///< longer than a pixel or two: drawn, not only splatted
};

/// Fits maps of at most longest_px around the box of the mesh; what lies outside is not drawn. The pixel is
/// no finer than the mesh can fill with points (mean_edge_mm), except where all faces get drawn because they
/// are few.
[[nodiscard]] DepthMapPlan plan_depth_maps(const Mesh& mesh, const Eigen::AlignedBox3f& box,
                                           double mean_edge_mm, int longest_px);

/// The nearest and the farthest surface along one direction, by pixel, as depths from the centre in mm
/// (larger is nearer to an eye at infinity in that direction).
class DepthMapPair {
 public:
  /// area_mm2: [V]; a vertex without any is of no surface and hides nothing.
  DepthMapPair(const Mesh& mesh, std::span<const float> area_mm2, const DepthMapPlan& plan,
               const Eigen::Vector3f& direction);

  struct Place {
    std::size_t pixel;
    float depth_mm;
  };
  /// Of a point that the map holds.
  [[nodiscard]] Place place(const Eigen::Vector3f& p_mm) const {
    const float x = p_mm.dot(u_px_) + offset_u_px_;
    const float y = p_mm.dot(v_px_) + offset_v_px_;
    return {static_cast<std::size_t>(static_cast<int>(y)) * static_cast<std::size_t>(side_) +
                static_cast<std::size_t>(static_cast<int>(x)),
            p_mm.dot(direction_)};
  }
  [[nodiscard]] bool holds(const Eigen::Vector3f& p_mm) const {
    const float x = p_mm.dot(u_px_) + offset_u_px_;
    const float y = p_mm.dot(v_px_) + offset_v_px_;
    const auto side = static_cast<float>(side_);
    return x >= 0 && y >= 0 && x < side && y < side;
  }
  [[nodiscard]] float nearest_mm(std::size_t pixel) const { return nearest_[pixel]; }
  [[nodiscard]] float farthest_mm(std::size_t pixel) const { return farthest_[pixel]; }
  [[nodiscard]] const Eigen::Vector3f& direction() const { return direction_; }

 private:
  void splat(const Eigen::Vector3f& p_mm);
  void draw(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);

  Eigen::Vector3f direction_;
  Eigen::Vector3f u_px_, v_px_;  ///< scaled to pixels
  float offset_u_px_ = 0, offset_v_px_ = 0;
  int side_ = 0;
  BigArray<float> nearest_, farthest_;
};

/// count unit directions spread over the upper half of the sphere (a Fibonacci spiral): one of each opposite
/// pair.
[[nodiscard]] std::vector<Eigen::Vector3f> half_sphere_directions(int count);

}  // namespace dubsar
