// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/mesh.h"

namespace dubsar {

struct RayHit {
  double distance_mm = 0;
  std::uint32_t face = 0;
  Eigen::Vector3f normal{0, 0, 0};  ///< geometric, unit, counter-clockwise side
  float u = 0, v = 0;               ///< barycentric: p = (1-u-v) a + u b + v c
};

struct ClosestPoint {
  Eigen::Vector3f point_mm{0, 0, 0};
  double distance_mm = 0;
  std::uint32_t face = 0;
};

/// Ray casting and closest point on a mesh (Embree). Copies what it needs; immutable after construction and
/// safe to query from many threads. Watertight intersection (robust mode), so a ray does not slip between two
/// faces.
class MeshQuery {
 public:
  explicit MeshQuery(const Mesh& mesh);
  ~MeshQuery();
  MeshQuery(MeshQuery&&) noexcept;
  MeshQuery& operator=(MeshQuery&&) noexcept;
  MeshQuery(const MeshQuery&) = delete;
  MeshQuery& operator=(const MeshQuery&) = delete;

  /// First hit from origin along the unit direction within [near_mm, far_mm].
  [[nodiscard]] std::optional<RayHit> first_hit(const Eigen::Vector3f& origin_mm,
                                                const Eigen::Vector3f& direction, float near_mm,
                                                float far_mm) const;
  /// True when anything lies on the open segment from a to b, ends excluded by margin_mm.
  [[nodiscard]] bool occluded(const Eigen::Vector3f& a_mm, const Eigen::Vector3f& b_mm,
                              float margin_mm) const;
  /// Nearest point of the surface within radius_mm.
  [[nodiscard]] std::optional<ClosestPoint> closest(const Eigen::Vector3f& p_mm, float radius_mm) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
