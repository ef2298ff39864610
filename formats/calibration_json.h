// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// The calibration of a rig as it is kept (docs/formats/calibration.md).
[[nodiscard]] std::string calibration_to_json(const RigCalibration& calibration);
/// Errors (kBadInput): what is missing or cannot be, RigCalibration::check() included.
[[nodiscard]] Result<RigCalibration> parse_calibration(std::string_view text, const std::string& where);

/// The word for a motion in files, and back ("linear", "galvanometer", "turntable").
[[nodiscard]] const char* motion_word(MotionKind kind);
[[nodiscard]] const std::vector<std::string>& motion_words();  ///< in the order of MotionKind

}  // namespace dubsar
