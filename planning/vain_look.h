// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace dubsar {

/// A scan that might have sampled a place densely, and did not.
struct VainLook {
  Eigen::Vector3d towards_scanner{0, 0, 1};  ///< unit, model frame
  Eigen::Vector3d towards_camera{0, 0, 1};   ///< unit, from the place; as towards_scanner where unknown
  double chance = 1;                         ///< that it would
};

/// A scan that predicts this chance ought to have seen the place.
inline constexpr double kTriedChance = 0.5;

/// How many of them ought to have seen it, each from elsewhere: laser or camera stood at least 15° from where
/// it stood for each that is counted already. Who looks four times without moving has looked once.
[[nodiscard]] std::size_t full_looks_apart(std::span<const VainLook> looks);

/// The looks in full ones: one of less chance counts as the part of kTriedChance that it has.
[[nodiscard]] double looks_worth(std::span<const VainLook> looks);

/// What the looks leave of the chance that a scan from that side samples the place: much less each from the
/// same side, a little less each from elsewhere, but for those that stood where another had stood.
[[nodiscard]] double novelty(std::span<const VainLook> looks, const Eigen::Vector3d& towards_scanner);

}  // namespace dubsar
