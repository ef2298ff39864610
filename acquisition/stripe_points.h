// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "acquisition/stripe.h"

namespace dubsar {

/// The good samples of a profile as image points.
[[nodiscard]] inline std::vector<Eigen::Vector2d> stripe_points(const StripeProfile& profile,
                                                                StripeAxis axis) {
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < profile.at_px.size(); ++i) {
    if (profile.state[i] == StripeState::kGood) {
      const auto at = static_cast<double>(profile.at_px[i]);
      const auto across = static_cast<double>(i);
      out.push_back(axis == StripeAxis::kPerColumn ? Eigen::Vector2d(across, at)
                                                   : Eigen::Vector2d(at, across));
    }
  }
  return out;
}

}  // namespace dubsar
