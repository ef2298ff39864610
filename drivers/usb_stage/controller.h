// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/usb_stage/firmware.h"
#include "drivers/usb_stage/gate.h"
#include "drivers/usb_stage/guard.h"
#include "drivers/usb_stage/link.h"

namespace dubsar::usb_stage {

/// How a controller is reached: made anew after every failure.
struct Ways {
  std::function<Result<std::unique_ptr<Link>>()> link;
  std::function<Result<std::unique_ptr<Firmware>>(Link&)> firmware;
  /// Absent: no guard, for links that no other process can open.
  std::function<Result<std::unique_ptr<Guard>>(const std::string& panic)> guard;
  /// A search for the switches that takes longer has failed: a motor that slips turns for ever.
  std::chrono::milliseconds homing = std::chrono::minutes(3);
};

/// A stage from open to close, plugged in or not: limits, waiting, lasers, stops. stop() and emergency_stop()
/// are for any thread, everything else for one at a time.
class Controller {
 public:
  /// kDevice when the controller is not there or is none.
  [[nodiscard]] static Result<std::unique_ptr<Controller>> open(Ways ways, std::string where);
  /// Lasers off, motion ended.
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// As found when it was connected first.
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  [[nodiscard]] int lasers() const { return static_cast<int>(power_.size()); }
  [[nodiscard]] const std::string& where() const { return where_; }

  Status home();
  /// speed 0: the share of the axis's greatest that set_speed() made of the first axis's, at first half.
  Status move(std::size_t axis, double position, double speed, bool start_only);
  struct Motion {
    Position position;
    bool homed = false;
    std::vector<double> power;
  };
  [[nodiscard]] Result<Motion> read();
  /// Off is at once: where the firmware would obey only behind a move, that move ends, with kCancelled.
  Status set_laser(std::size_t laser, double power);
  /// OK: the controller has answered, or there was nothing to end. kDevice: it may not have obeyed, or was
  /// lost with its laser on or its stage in motion, and nobody has put that to an end since.
  Status stop();
  /// As stop(); what other threads have asked for and not sent by now is not sent any more.
  Status emergency_stop();

  /// Of the first axis.
  [[nodiscard]] double speed() const { return speed_share_ * axes_.front().speed_maximum; }
  void set_speed(double speed) { speed_share_ = speed / axes_.front().speed_maximum; }

 private:
  Controller(Ways ways, std::string where) : ways_(std::move(ways)), where_(std::move(where)) {}
  /// No guard seeks while it is connected.
  Status connect();
  Status connect_alone();
  /// Whether lasers are on.
  void tell_guard();
  /// For a controller that cannot be reached and was at work; called where nothing of it is open.
  void let_guard_seek();
  /// After an error of the device: what can be sent without an answer is sent, and the link dropped. False:
  /// that was not taken.
  bool drop();
  /// Drops a controller that has failed; of one that was at work and cannot be reached says what to do.
  Status settle(Status status);
  /// kDevice where it was lost at work.
  [[nodiscard]] Status gone() const;
  Status plausible(const Position& now);
  Result<Position> read_locked();
  Status end_locked();  ///< the motion, and the light
  Status ended(Status status);
  Status wait_for(std::size_t axis, double position, double speed, std::uint64_t stops);
  [[nodiscard]] std::unexpected<Error> stopped() const;
  [[nodiscard]] std::unexpected<Error> halted() const;
  [[nodiscard]] bool homes() const;

  Ways ways_;
  std::string where_;
  std::vector<Axis> axes_;
  std::string version_;
  std::atomic<double> speed_share_ = 0.5;

  std::mutex
      mutex_;  ///< of all below; held for one question and its answer, or a homing that looks at stops_
  std::shared_ptr<Gate> link_;
  std::unique_ptr<Firmware> firmware_;
  std::unique_ptr<Guard> guard_;
  std::vector<double> power_;
  std::optional<Position> last_;
  bool moves_ = false;         ///< a motion was asked for and not seen to have ended
  bool lost_at_work_ = false;  ///< with a laser on or in motion, and not connected since
  bool unheard_ = false;       ///< and what would have ended that was not taken

  std::mutex halt_mutex_;   ///< one emergency stop at a time
  std::mutex panic_mutex_;  ///< of the two that a halt uses without waiting for mutex_
  std::shared_ptr<Gate> panic_link_;
  std::string panic_bytes_;
  std::atomic<bool> halted_ = false;
  std::atomic<std::uint64_t> stops_ = 0;  ///< asked for so far; a move that sees more than it began with ends
};

}  // namespace dubsar::usb_stage
