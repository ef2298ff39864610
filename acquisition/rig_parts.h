// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "core/rig_calibration.h"
#include "drivers/device.h"
#include "formats/rig_toml.h"

namespace dubsar {

/// What all rigs do with their camera and their stage.

/// Of a scan that moves through: a row whose place is known less well than this share of a step (standard
/// deviation) is a lost row. Answers of a stage that come late, on a machine with too much work, do not say
/// where it was.
inline constexpr double kSureSteps = 0.25;

/// Puts a laser off. kDevice where the stage does not say that it is off: then people have to.
[[nodiscard]] Status put_off(Device& stage, std::uint32_t laser);

/// Puts a laser off when it goes, if nobody did before.
class LaserGuard {
 public:
  LaserGuard(Device& stage, std::uint32_t laser) : stage_(stage), laser_(laser) {}
  LaserGuard(const LaserGuard&) = delete;
  LaserGuard& operator=(const LaserGuard&) = delete;
  ~LaserGuard() { [[maybe_unused]] const Status said = off({}); }

  /// Puts it off now. `so_far` is how it went until then: a laser that may be lit is told whatever that was,
  /// before all else where nothing failed or somebody stopped it.
  [[nodiscard]] Status off(Status so_far);

 private:
  Device& stage_;
  std::uint32_t laser_;
  bool is_off_ = false;
};

/// Puts the settings of the file, in its order. kUsage: one that the camera does not have or take.
Status put_camera_settings(const RigFile& file, Device& camera, const std::string& where);

/// The axis that the file names. kUsage: no stage, no such axis, a scan beyond its limits; kBadInput: one
/// that moves otherwise.
[[nodiscard]] Result<StageAxis> axis_for_scan(const RigFile& file, Device& stage, MotionKind kind,
                                              const std::string& where);

/// Where the scan's last row lies, mm or rad.
[[nodiscard]] double end_of(const RigFile& file);

/// Where the stage is sent for a row, mm or rad: a sum of steps may round beyond the limit that it ends at.
[[nodiscard]] double row_position(const RigFile& file, const StageAxis& axis, int row);

/// kUsage: a turntable that would turn too far in one scan. A grid has one view, that of the middle of its
/// turn, by which its samples' normals, what hides what and what is red are told: from 60° on its ends would
/// be judged as clay that was hardly seen, and beyond 90° as seen from behind.
[[nodiscard]] Status check_turn(const RigFile& file, MotionKind kind, const std::string& where);

/// kBadInput: a scan that is said in the unit of another kind of stage than this.
[[nodiscard]] Status check_unit(const RigFile& file, MotionKind kind, const std::string& where);

/// kBadInput: a mirror that counts from wherever it stood when it was switched on. Its zero is where the
/// laser plane was calibrated: a degree beside it is millimetres of depth.
[[nodiscard]] Status check_zero(const StageAxis& axis, const Device& stage, MotionKind kind,
                                const std::string& where);

/// A place of an axis as people say it, in mm or degrees.
[[nodiscard]] std::string position_text(bool rotary, double position);

/// Where an axis of the stage is, mm or rad.
[[nodiscard]] Result<double> position_of(const Device& stage, std::size_t axis);

/// kCancelled where a stop was said: what a scan is about to move or to light stays as it is. A stop that
/// comes before the motion ends none, and whoever said it believes that nothing moves any more.
[[nodiscard]] Status unless_stopped(const std::atomic<bool>& stopped, const RigFile& file);

/// Positions mean nothing before a stage has found its switch: homes it, if it can and has not. `go_on` is
/// asked right before; nothing: it goes on.
Status home_once(Device& stage, int axis, const std::function<Status()>& go_on = {});

/// kUsage: a stage that does not tell where it is while it moves.
Status check_reports(const StageReading& reading, const RigFile& file);
[[nodiscard]] std::unexpected<Error> stopped_short(const RigFile& file, bool rotary, double position);

/// The way of a continuous scan.
struct Travel {
  double from = 0, to = 0;  ///< with room to gather speed, where the axis has it
  double speed = 0;         ///< mm/s or rad/s
  /// The whole way with starting and braking, at most.
  [[nodiscard]] std::chrono::milliseconds time_of_way() const;
  /// At most, from the last row until it stands.
  [[nodiscard]] std::chrono::milliseconds time_to_rest(double last_row) const;
};
[[nodiscard]] Travel travel_of(const RigFile& file, const StageAxis& axis, double speed);

}  // namespace dubsar
