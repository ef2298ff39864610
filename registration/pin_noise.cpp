// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_noise.h"

#include <cmath>

namespace dubsar {

void RowNoiseSums::add(std::span<const Residual> residuals) {
  for (std::size_t a = 0; a < residuals.size(); ++a) {
    for (std::size_t b = a; b < residuals.size() && residuals[b].row == residuals[a].row; ++b) {
      const std::uint32_t lag = residuals[b].col - residuals[a].col;
      if (lag >= RowNoise::kLags) {
        break;
      }
      sum_[lag] += residuals[a].mm * residuals[b].mm;
      ++count_[lag];
    }
  }
}

void RowNoiseSums::add(const RowNoiseSums& other) {
  for (std::size_t k = 0; k < RowNoise::kLags; ++k) {
    sum_[k] += other.sum_[k];
    count_[k] += other.count_[k];
  }
}

RowNoise RowNoiseSums::noise() const {
  RowNoise out;
  out.samples = count_[0];
  if (count_[0] == 0) {
    return out;
  }
  out.covariance_mm2[0] = sum_[0] / static_cast<double>(count_[0]);
  for (std::size_t k = 1; k < RowNoise::kLags && count_[k] > 0; ++k) {
    const double covariance = sum_[k] / static_cast<double>(count_[k]);
    if (covariance < 2.0 * out.covariance_mm2[0] / std::sqrt(static_cast<double>(count_[k]))) {
      break;
    }
    out.covariance_mm2[k] = covariance;
  }
  return out;
}

}  // namespace dubsar
