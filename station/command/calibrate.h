// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "station/command/command.h"

namespace dubsar {

/// Options of `dubsar calibrate --verify`.
struct VerifyOptions {
  std::string artefact;     ///< artefact.toml
  std::string calibration;  ///< whose log it goes into
  std::string unit;
  [[nodiscard]] bool wanted() const { return !artefact.empty(); }
};
void add_verify_options(CLI::App& verb, VerifyOptions& options);
/// Measures the artefact in a scan, prints and logs the outcome.
[[nodiscard]] Result<int> verify_rig(const VerifyOptions& options, const std::string& scan,
                                     CommandContext& context);

/// Options of `dubsar calibrate --rig`.
struct LiveOptions {
  std::string rig;     ///< rig.toml
  std::string motion;  ///< linear, turntable, galvanometer or none; empty: as the rig's files tell
  int stops = 5;
  std::optional<double> depth_range_mm, plate_margin_mm;
  double board_exposure_us = 0;  ///< 0: as the camera stands
  double laser_exposure_us = 0;
  [[nodiscard]] bool wanted() const { return !rig.empty(); }
};
void add_live_options(CLI::App& verb, LiveOptions& options);
/// Takes the pictures into the folder, led by what is missing; each line of standard input is a word of the
/// operator. Where the calibration belongs, as the rig's file says.
[[nodiscard]] Result<std::string> take_pictures(const LiveOptions& options, const std::string& board,
                                                const std::string& folder, CommandContext& context);

}  // namespace dubsar
