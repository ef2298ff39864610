// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dubsar {

/// A unit vector in four bytes, within 0.004 degrees: the octahedral map (Meyer et al. 2010), or zero.
class PackedNormal {
 public:
  PackedNormal() = default;
  explicit PackedNormal(const Eigen::Vector3f& n) {
    const float sum = n.cwiseAbs().sum();
    if (!(sum > 0)) {
      return;
    }
    float u = n.x() / sum;
    float v = n.y() / sum;
    if (n.z() < 0) {
      const float folded = (1.0F - std::abs(v)) * (u < 0 ? -1.0F : 1.0F);
      v = (1.0F - std::abs(u)) * (v < 0 ? -1.0F : 1.0F);
      u = folded;
    }
    u_ = rounded(u);
    v_ = rounded(v);
  }
  [[nodiscard]] bool is_zero() const { return u_ == kZero; }
  [[nodiscard]] Eigen::Vector3f unpack() const {
    if (is_zero()) {
      return Eigen::Vector3f::Zero();
    }
    float u = static_cast<float>(u_) / kScale;
    float v = static_cast<float>(v_) / kScale;
    const float z = 1.0F - std::abs(u) - std::abs(v);
    const float fold = std::max(-z, 0.0F);
    u += u < 0 ? fold : -fold;
    v += v < 0 ? fold : -fold;
    return Eigen::Vector3f(u, v, z) * (1.0F / std::sqrt(u * u + v * v + z * z));
  }

 private:
  static constexpr float kScale = 32767.0F;
  static constexpr std::int16_t kZero = std::numeric_limits<std::int16_t>::min();
  [[nodiscard]] static std::int16_t rounded(float x) {
    const float scaled = std::clamp(x, -1.0F, 1.0F) * kScale;
    return static_cast<std::int16_t>(scaled + (scaled < 0 ? -0.5F : 0.5F));
  }
  std::int16_t u_ = kZero;
  std::int16_t v_ = 0;
};

}  // namespace dubsar
