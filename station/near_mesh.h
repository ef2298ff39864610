// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/mesh.h"

namespace dubsar {

/// Whether a place lies near a vertex of the mesh, by cubes of space: within one side surely, beyond four
/// not.
class NearMesh {
 public:
  NearMesh(const Mesh& mesh, float side_mm) : side_mm_(side_mm) {
    if (!(side_mm_ > 0)) {
      return;
    }
    cubes_.reserve(mesh.positions.size());
    for (const Eigen::Vector3f& p : mesh.positions) {
      cubes_.push_back(key(cube_of(p)));
    }
    std::ranges::sort(cubes_);
    cubes_.erase(std::unique(cubes_.begin(), cubes_.end()), cubes_.end());
  }
  /// True of all places where side_mm is not positive.
  [[nodiscard]] bool has(const Eigen::Vector3f& p) const {
    if (!(side_mm_ > 0)) {
      return true;
    }
    const Eigen::Vector3i at = cube_of(p);
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i beside = at + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (std::ranges::binary_search(cubes_, key(beside))) {
        return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] Eigen::Vector3i cube_of(const Eigen::Vector3f& p) const {
    return (p / side_mm_).array().floor().max(-1e6F).min(1e6F).cast<int>().matrix();
  }
  static std::int64_t key(const Eigen::Vector3i& cube) {
    constexpr std::int64_t kHalf = std::int64_t{1} << 20U;
    return ((cube.x() + kHalf) << 42U) | ((cube.y() + kHalf) << 21U) | (cube.z() + kHalf);
  }

  float side_mm_;
  std::vector<std::int64_t> cubes_;
};

}  // namespace dubsar
