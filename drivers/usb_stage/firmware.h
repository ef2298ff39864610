// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "drivers/usb_stage/link.h"

namespace dubsar::usb_stage {

/// mm or rad in one mm or degree, which is what people and their firmwares count in.
[[nodiscard]] constexpr double unit_of(bool rotary) {
  return rotary ? rad_from_deg(1) : 1.0;
}

/// One axis, in mm or rad and seconds.
struct Axis {
  std::string name;
  bool rotary = false;
  bool can_home = false;
  bool endless = false;
  double minimum = 0;  ///< soft limits
  double maximum = 0;
  double speed_maximum = 0;
  double resolution = 0;
  std::pair<double, double> reach;  ///< where it may be found: within its limits, at its switch, at its ends
};

struct Position {
  std::vector<double> axes;  ///< mm or rad
  bool moving = false;
  bool alarm = false;
  bool commanded = false;  ///< the firmware does not say where it is
  std::int64_t timestamp_ns = 0;
  std::int64_t uncertainty_ns = 0;
};

/// What the operator says about axes; the firmware's own word, where it has one, fills the rest.
struct AxisWish {
  std::string name = "x";
  bool rotary = false;
  std::optional<std::pair<double, double>> limits;  ///< mm or degrees
};

/// Whether somebody wants a wait to end.
using Cancelled = std::function<bool()>;

/// A controller's language. One thread at a time; every call ends in time. An error of kDevice means that the
/// controller cannot be trusted any more: drop the link and connect anew.
class Firmware {
 public:
  virtual ~Firmware() = default;
  /// Finds out what it is, with lasers off and nothing moving afterwards.
  virtual Status connect() = 0;
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  [[nodiscard]] int lasers() const { return lasers_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  /// Whether lasers have powers between off and on.
  [[nodiscard]] bool dims() const { return dims_; }
  /// Whether positions are those of the machine.
  [[nodiscard]] bool homed() const { return homed_; }

  /// Returns once the move is accepted. speed > 0.
  virtual Status start_move(std::size_t axis, double position, double speed) = 0;
  virtual Result<Position> read() = 0;
  virtual Status set_laser(int laser, double power) = 0;
  /// Whether set_laser() is obeyed only when the move before it is over.
  [[nodiscard]] virtual bool light_waits() const { return true; }
  /// Ends the motion with the position known, lasers off.
  virtual Status stop() = 0;
  /// Waits for the switches until cancelled(): a firmware may say nothing on the way. kCancelled then; the
  /// axes stand still.
  virtual Status home(const Cancelled& cancelled) = 0;
  /// Afterwards nothing moves until it is homed or connected anew.
  virtual Status halt() = 0;
  /// Bytes that end all motion and put the lasers off, whatever is going on; sent without waiting.
  [[nodiscard]] virtual std::string panic() const = 0;

 protected:
  std::vector<Axis> axes_;
  int lasers_ = 1;
  bool dims_ = false;
  std::string version_;
  bool homed_ = false;
};

[[nodiscard]] std::unique_ptr<Firmware> make_grbl(Link& link, const std::vector<AxisWish>& axes,
                                                  const std::string& where);
[[nodiscard]] std::unique_ptr<Firmware> make_horus(Link& link, const std::vector<AxisWish>& axes,
                                                   const std::string& where);

/// The one of these two whose banner a reset brings. kDevice when none comes.
[[nodiscard]] Result<std::unique_ptr<Firmware>> make_by_banner(Link& link, const std::vector<AxisWish>& axes,
                                                               const std::string& where);

struct TmclOptions {
  std::vector<double> steps;       ///< of each axis: microsteps per mm, or per degree
  std::vector<double> speeds_max;  ///< of each axis: mm/s or degrees/s
  int module = 1;
  int laser_output = 0;
  bool switches = true;  ///< to home to
};
[[nodiscard]] std::unique_ptr<Firmware> make_tmcl(Link& link, const std::vector<AxisWish>& axes,
                                                  const TmclOptions& options, const std::string& where);

/// Nanoseconds of CLOCK_MONOTONIC, which is what steady_clock reads here.
[[nodiscard]] inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

}  // namespace dubsar::usb_stage
