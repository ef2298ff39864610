// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// Pictures for a calibration as a folder's calibration.toml names them (docs/formats/calibration.md).
struct CalibrationSet {
  struct Pose {
    std::string board;  ///< file with the laser off
    std::string laser;  ///< the same pose with the laser on; empty when there is none
    std::string dark;   ///< taken as `laser` was, with the laser off; empty when there is none
    double mirror_rad = 0;
  };
  struct Stop {
    std::string board;
    std::string fixed;     ///< which board: those of one name lie still on the stage
    double position = 0;   ///< mm or radians
  };
  std::string board;  ///< as parse_board() reads it
  std::optional<MotionKind> motion;
  std::string camera_serial;
  double depth_range_mm = 40;
  std::optional<double> temperature_c;
  std::string note;
  double stripe_sigma_px = 1.2;
  bool stripe_per_row = false;
  std::vector<Pose> poses;
  std::vector<Stop> stops;
};

/// File names are relative and stay inside the folder. Errors: kBadInput.
[[nodiscard]] Result<CalibrationSet> parse_calibration_set(std::string_view toml, const std::string& where);
[[nodiscard]] std::string calibration_set_to_toml(const CalibrationSet& set);

}  // namespace dubsar
