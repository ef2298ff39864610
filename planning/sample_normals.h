// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/big_array.h"
#include "core/range_grid.h"

namespace dubsar {

/// The normals of all samples of a grid (clearing.h, sample_normal) in four bytes each, good to a fifth of a
/// degree: clearing asks for them millions of times, in no order that the grid would like.
class SampleNormals {
 public:
  /// Uses all cores.
  SampleNormals(const RangeGrid& grid, float step_mm);

  /// Scanner frame; about unit, zero where it is undefined.
  [[nodiscard]] Eigen::Vector3f operator[](std::size_t sample) const {
    const std::uint32_t packed = packed_[sample];
    const auto part = [&](int shift) {
      return static_cast<float>(static_cast<std::int32_t>((packed >> shift) & 0x3FFU) - kZero) *
             (1.0F / kOne);
    };
    return {part(0), part(10), part(20)};
  }

 private:
  static constexpr std::int32_t kZero = 512;
  static constexpr float kOne = 511;

  BigArray<std::uint32_t> packed_;  ///< [rows*cols], ten bits each
};

}  // namespace dubsar
