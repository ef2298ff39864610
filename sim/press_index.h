// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/impression.h"

namespace dubsar::sim {

/// Which impressions may touch a point: buckets over space, each with its impressions in writing order.
class PressIndex {
 public:
  PressIndex(const std::vector<Impression>& impressions, const Eigen::Vector3d& half_size_mm);
  [[nodiscard]] std::span<const std::uint32_t> near(const Eigen::Vector3d& p_mm) const;

 private:
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3d& p_mm) const;
  [[nodiscard]] std::size_t bucket(const Eigen::Vector3i& cell) const;

  Eigen::Vector3d low_;
  Eigen::Vector3i cells_;
  std::vector<std::uint32_t> start_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace dubsar::sim
