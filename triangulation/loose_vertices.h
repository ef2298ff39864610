// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "triangulation/front.h"

namespace dubsar {

/// Finds the loose vertices of a sheet near a place. They are few; they must not change while it lives.
class LooseVertices {
 public:
  explicit LooseVertices(const Sheet& sheet);

  [[nodiscard]] bool empty() const { return cells_.empty(); }
  /// Those within the ball, ascending.
  [[nodiscard]] std::vector<std::uint32_t> near(const Eigen::Vector3f& p_mm, float radius_mm) const;

 private:
  [[nodiscard]] std::uint64_t key_of(int x, int y, int z) const;
  [[nodiscard]] int cell_of(float mm) const;

  const Sheet* sheet_;
  float cells_per_mm_ = 1;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace dubsar
