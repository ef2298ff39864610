// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/calibration.h"
#include "core/job.h"
#include "drivers/device.h"
#include "formats/calibration_set.h"

namespace dubsar {

/// What is calibrated, and with what.
struct LiveCalibrationPlan {
  /// Board, motion and stripe; poses and stops come as they are taken. The names of files are chosen here.
  CalibrationSet set;
  std::filesystem::path folder;  ///< for the pictures; one that has some is gone on with
  int axis = 0;                  ///< of the stage
  int laser = 0;
  double laser_power = 1;
  double from = 0, to = 0;  ///< of the stage, where it takes the board (or turns the mirror); mm or radians
  double speed = 0;         ///< of it, mm/s or rad/s; 0: as the stage likes
  int stops = 5;
  /// In place of those of `set`, or of the folder that is gone on with.
  std::optional<double> depth_range_mm, plate_margin_mm;
  std::optional<double> board_exposure_us;  ///< for pictures of the board; else as the camera stands
  std::optional<double> laser_exposure_us;  ///< for pictures of the stripe
};

/// A calibration taken with the rig itself: lights the laser, takes the pictures, moves the stage, looks at
/// once whether they are of use, and says what to do next. Every picture that is used is in the folder, with
/// a calibration.toml, as soon as it is told; what look_at_pictures() makes of it later is the same. Use from
/// one thread.
class LiveCalibration {
 public:
  /// Errors: kUsage (no camera; no stage or axis; a board or limits that cannot be), kBadInput (the folder
  /// holds another calibration), kDevice, kStorage.
  [[nodiscard]] static Result<LiveCalibration> start(const LiveCalibrationPlan& plan, Device camera,
                                                     Device stage, const JobContext& job);

  struct Taken {
    bool used = false;
    std::string said;  ///< what was seen, or why it is of no use
  };
  /// The board held still: a picture with the laser off, one with it on, one with it off again. Of no use: no
  /// board, or one that moved meanwhile. The laser is off afterwards. Errors: kDevice, kStorage,
  /// kCancelled when `job` was cancelled and the stage has obeyed.
  [[nodiscard]] Result<Taken> take_pose(const JobContext& job);
  /// The board lying on the stage, which goes to its stops. Of no use: a board that is seen at fewer than
  /// three.
  [[nodiscard]] Result<Taken> take_stops(const JobContext& job);

  /// What is missing, most useful first; empty when nothing is.
  [[nodiscard]] std::vector<std::string> next() const;
  [[nodiscard]] int poses() const { return static_cast<int>(plan_.set.poses.size()); }
  [[nodiscard]] int stops() const { return static_cast<int>(plan_.set.stops.size()); }
  /// From all that was taken; as calibrate_rig().
  [[nodiscard]] Result<CalibrationReport> calibrate() const;

 private:
  LiveCalibration(LiveCalibrationPlan plan, BoardSpec board, Device camera, Device stage);
  Status expose(const std::optional<double>& exposure_us);
  [[nodiscard]] Result<GrayImage> picture(bool laser, const std::optional<double>& exposure_us,
                                          const JobContext& job);
  [[nodiscard]] Result<Taken> pose_while_streaming(const JobContext& job);
  [[nodiscard]] Result<Taken> stops_while_streaming(const JobContext& job);
  [[nodiscard]] CalibrationOptions options() const;
  Status keep() const;

  LiveCalibrationPlan plan_;
  BoardSpec board_;
  double before_ = 0;  ///< from there its first stop is driven to, as the others are: a screw has some play
  Device camera_;
  Device stage_;
  std::vector<CalibrationView> views_;
};

}  // namespace dubsar
