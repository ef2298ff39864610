// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar {

/// Residuals of neighbouring samples of a profile hang together (speckle, seed 001's scanners and ours), so
/// that a fit knows less than its number of samples says. Autocovariance of residuals along the rows.
struct RowNoise {
  static constexpr std::size_t kLags = 9;
  std::array<double, kLags> covariance_mm2{};  ///< by distance in columns; [0] is the variance
  std::size_t samples = 0;

  [[nodiscard]] double at(int lag) const {
    return lag >= 0 && lag < static_cast<int>(kLags) ? covariance_mm2[static_cast<std::size_t>(lag)] : 0.0;
  }
};

/// Residual of one sample of a grid.
struct Residual {
  std::uint32_t row = 0, col = 0;
  double mm = 0;
};

/// Pools series of residuals, each in row order. A covariance that its own statistics cannot tell from zero
/// ends the correlation: later lags are 0.
class RowNoiseSums {
 public:
  void add(std::span<const Residual> residuals);
  void add(const RowNoiseSums& other);
  [[nodiscard]] RowNoise noise() const;

 private:
  std::array<double, RowNoise::kLags> sum_{};
  std::array<std::size_t, RowNoise::kLags> count_{};
};

}  // namespace dubsar
