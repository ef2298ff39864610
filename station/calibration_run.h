// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/calibration.h"
#include "core/gray_image.h"
#include "core/job.h"
#include "core/result.h"
#include "core/rig_calibration.h"

namespace dubsar {

struct CalibrateRequest {
  std::string folder;  ///< with a calibration.toml, or with pictures of the board alone
  std::string board;   ///< as parse_board() reads it; may be empty where calibration.toml says it
  std::string serial;  ///< of the camera; empty: as calibration.toml says
  std::string out;     ///< calibration.json; empty: it is not written
  std::optional<double> temperature_c = {};  ///< of the room; nothing: as calibration.toml says
};

struct CalibrateOutcome {
  CalibrationReport report;
  std::vector<std::string> left_out;  ///< pictures without a board, and why
};

/// Calibrates from the pictures of a folder. A calibration that lacks something is an outcome (`missing`);
/// one that is worse than it may be is refused, and so is one in the place of another camera's. Errors:
/// kUsage, kBadInput, kStorage, kCancelled.
[[nodiscard]] Result<CalibrateOutcome> calibrate_folder(const CalibrateRequest& request,
                                                        const JobContext& job);

/// What the stage of a device "rig:FILE" does, as far as its files tell: its calibration, where it has one,
/// else whether the scan is said in degrees. Linear for any other device.
[[nodiscard]] MotionKind stage_kind_of(const std::string& device_uri);

/// Where the calibration of a device "rig:FILE" belongs, as FILE says, be it there yet or not. Empty for any
/// other device, and for a range camera, which has none.
[[nodiscard]] std::string calibration_place_of(const std::string& device_uri);

/// What the operator says of all pictures of a calibration.
struct CalibrationWords {
  std::string board;
  MotionKind motion = MotionKind::kLinear;
  std::optional<double> temperature_c;  ///< of the room
};

/// What a picture of a calibration shows. Board, laser and dark are of one pose of the board.
enum class CalibrationShot {
  kBoard,  ///< lit, laser off: begins a new pose
  kLaser,  ///< the same pose, laser on
  kDark,   ///< as kLaser was taken, laser off
  kStop,   ///< the board that lies still on the stage, at `position`
};

struct CalibrationPicture {
  CalibrationShot shot = CalibrationShot::kBoard;
  GrayImage image;
  std::string camera_serial;  ///< empty when not known
  /// Of the stage: of a slide or a turntable for kStop, of a mirror for kBoard; mm, or degrees of what turns.
  double position = 0;
};

/// Adds a picture to a calibration's folder, which is made, and to its calibration.toml. Returns the name of
/// its file. Errors: kUsage for laser and dark before any board and for a board on a mirror, kBadInput for a
/// calibration.toml that cannot be read or is of another camera or stage, kStorage.
[[nodiscard]] Result<std::string> add_calibration_shot(const std::filesystem::path& folder,
                                                       const CalibrationWords& words,
                                                       const CalibrationPicture& picture);

}  // namespace dubsar
