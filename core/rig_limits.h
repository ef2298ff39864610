// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

/// Beyond these no rig is: a slip, or a faulty driver. One that tells more is refused before anything is
/// stored, for what a session keeps of its rig is held against the same limits when it is read again.
inline constexpr double kMostRigSpacingMm = 1e3;
inline constexpr double kMostDepthRangeMm = 1e6;
inline constexpr double kMostSupportHeightMm = 1e6;  ///< above or below the stage
inline constexpr double kMostCalibrationAgeDays = 1e6;

}  // namespace dubsar
