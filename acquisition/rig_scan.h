// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/rig_parts.h"
#include "acquisition/rig_source.h"
#include "acquisition/row_pitch.h"
#include "acquisition/row_window.h"
#include "acquisition/triangulate.h"
#include "core/rig.h"
#include "drivers/device.h"
#include "formats/rig_toml.h"

namespace dubsar {

/// A camera, a stage with a laser, and the calibration that belongs to them, as one range source. Use from
/// one thread at a time; stop() from any.
class RigScanner : public RigSource {
 public:
  /// Checks that the parts fit: a camera that yields frames, a stage with the axis (a rotary one for
  /// turntable and mirror), a whole calibration of this very camera (by its serial number), a scan within the
  /// axis' limits. Puts the camera's settings. Errors: kUsage, kBadInput, kDevice.
  [[nodiscard]] static Result<RigScanner> make(const RigFile& file, const RigCalibration& calibration,
                                               Device camera, Device stage, const std::string& where);

  /// What it sees and how old its calibration is, counted from `calibration.made_at`.
  [[nodiscard]] const Rig& rig() const { return rig_; }
  [[nodiscard]] const std::string& device_id() const { return device_id_; }

  /// One scan; the stage is homed before the first, where it has to be. Row by row: drives to the row, takes
  /// a frame with the laser off (where the file asks for ambient frames) and one with it on. Continuous: the
  /// stage moves through, every frame of the camera is a row, and its time says where the stage was; the
  /// sink's begin() waits until it is known how far apart they come. Rows
  /// close enough together correct each other (SweptLight) and come a few rows late. The laser is off
  /// afterwards, whatever happened.
  Status scan(ProfileSink& sink) override;
  /// Between scans: the camera's frames as a scan would see them, the laser lit and nothing moving.
  Status start_view() override;
  Status stop_view() override;
  Status light_view(bool lit) override;
  [[nodiscard]] Device* camera() override { return &camera_; }
  /// Ends the motion and puts the laser off; a scan that runs returns kCancelled soon.
  Status stop() override;
  Status halt() override;
  [[nodiscard]] const Rig* geometry() const override { return &rig_; }

 private:
  RigScanner(const RigFile& file, const RigCalibration& calibration, Device camera, Device stage,
             StripeAxis axis);
  [[nodiscard]] Status check_frame(const Frame& frame) const;
  /// Before row 0, which is then driven to from the side that all rows are: a screw has some play.
  Status approach();
  Status row(int number, ProfileSink& sink, ScanTally& tally);
  [[nodiscard]] Result<Travel> plan_sweep();
  Status sweep(const Travel& plan, ProfileSink& sink, ScanTally& tally);
  /// Tells the sink of the scan, whose rows are pitch_ apart, and hands on those that waited for that.
  Status begin(ProfileSink& sink, ScanTally& tally);
  Status hand_on(SweptRow row, ProfileSink& sink, ScanTally& tally);
  [[nodiscard]] RowWindow::Give giving(ProfileSink& sink, ScanTally& tally) const;

  RigFile file_;
  StageAxis axis_;
  Device camera_;
  Device stage_;
  std::unique_ptr<Triangulator> triangulator_;
  StripeExtractor extractor_;
  Rig rig_;
  std::string device_id_;
  std::unique_ptr<std::atomic<bool>> stopped_;
  GrayImage dark_;
  // Of the scan that runs.
  std::int64_t began_ns_ = 0;
  std::optional<RowPitch> pitch_;
  std::vector<SweptRow> waiting_;      ///< until the sink has begun
  std::unique_ptr<RowWindow> window_;  ///< there once the sink has begun
};

/// Days from an ISO 8601 time in UTC until now; nothing when the text is none, or a time to come: then the
/// clock of now or of then is wrong.
[[nodiscard]] std::optional<double> days_since(const std::string& iso_8601);

}  // namespace dubsar
