// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "core/rig.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// A part of a camera's picture, pixels; x and y are those of its first corner.
struct PictureRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

/// A rig put together from parts, as rig.toml names them (docs/formats/rig_toml.md).
struct RigFile {
  std::string name;
  std::string camera;               ///< device URI
  std::string stage;                ///< device URI
  std::string calibration;          ///< file, relative to rig.toml; empty: a range camera, which needs none
  std::optional<RigMotion> motion;  ///< of a range camera: how the stage moves it, in its own frame
  /// Settings of the camera, put in this order before the first scan; the words as they stand.
  std::vector<std::pair<std::string, std::string>> camera_settings;
  std::optional<PictureRegion> region;  ///< of the calibrated picture, that the camera is to send
  int axis = 0;                         ///< of the stage, that moves while a scan runs
  int laser = 0;                        ///< of the stage
  double laser_power = 1;
  double start = 0;    ///< of the stage at row 0; mm or radians
  double step = 0;     ///< from row to row, > 0
  bool turns = false;  ///< the scan is said in degrees: a turntable or a mirror
  int rows = 0;
  double speed = 0;         ///< mm/s or rad/s; 0: as the stage likes
  bool continuous = false;  ///< the stage moves through, and rows come at the camera's rate
  bool ambient = true;      ///< take a frame with the laser off at each row
  double stripe_sigma_px = 1.2;
  std::string stripe_method = "adaptive";
  bool stripe_per_row = false;
  bool hand_turns = true;
  double support_height_mm = -1e6;  ///< scanner frame counts: nothing is known of a support
  std::optional<HeadBox> head;
};

/// Errors: kBadInput.
[[nodiscard]] Result<RigFile> parse_rig_file(std::string_view toml, const std::string& where);

}  // namespace dubsar
