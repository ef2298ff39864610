// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/controller.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "core/number_text.h"

namespace dubsar::usb_stage {

namespace {

using namespace std::chrono_literals;

/// Between two questions to a stage that moves.
constexpr auto kAskEvery = 5ms;
/// A stage that stands still short of its target for so long does not go on.
constexpr auto kStandstill = 500ms;
/// Beyond the time that the way takes, for starting and braking.
constexpr auto kGrace = 2s;
/// How far beyond its reach or its speed a report may be before it is impossible.
constexpr double kSlack = 0.05;
constexpr double kSpeedSlack = 3;

constexpr const char* kPullPlugs = "pull the plugs of laser and stage, or switch off their power";

std::string shown(const Axis& axis, double value) {
  return fixed_text(value / unit_of(axis.rotary), 3) + (axis.rotary ? " deg" : " mm");
}

/// What counts as arrived: two steps of the motor, or a micrometre where the steps are not known.
double tolerance(const Axis& axis) {
  return std::max(2 * axis.resolution, 1e-3);
}

}  // namespace

Result<std::unique_ptr<Controller>> Controller::open(Ways ways, std::string where) {
  std::unique_ptr<Controller> out(new Controller(std::move(ways), std::move(where)));
  const std::lock_guard lock(out->mutex_);
  if (const Status connected = out->connect(); !connected) {
    return std::unexpected(connected.error());
  }
  out->axes_ = out->firmware_->axes();
  out->version_ = out->firmware_->version();
  return out;
}

Status Controller::connect() {
  if (firmware_) {
    return {};
  }
  if (guard_ && guard_->seeks()) {
    guard_.reset();  // first: two that talk on one line take each other's answers
  }
  Status connected = connect_alone();
  if (!connected && unheard_) {
    let_guard_seek();
  }
  return connected;
}

Status Controller::connect_alone() {
  const auto out_of_reach = [this](Error error) -> Status {
    error.mend = lost_at_work_ ? kPullPlugs : error.mend;
    return std::unexpected(std::move(error));
  };
  Result<std::unique_ptr<Link>> link = ways_.link();
  if (!link) {
    return out_of_reach(link.error());
  }
  link_ = std::make_shared<Gate>(std::move(*link));
  Result<std::unique_ptr<Firmware>> firmware = ways_.firmware(*link_);
  if (!firmware) {
    link_.reset();
    return out_of_reach(firmware.error());
  }
  if (const Status connected = (*firmware)->connect(); !connected) {
    firmware->reset();
    link_.reset();
    return out_of_reach(connected.error());
  }
  firmware_ = std::move(*firmware);
  power_.assign(static_cast<std::size_t>(firmware_->lasers()), 0.0);
  last_.reset();
  moves_ = lost_at_work_ = unheard_ = false;  // connect() puts lasers off, and nothing moves
  const std::lock_guard lock(panic_mutex_);
  panic_link_ = link_;
  panic_bytes_ = firmware_->panic();
  return {};
}

bool Controller::drop() {
  const bool lit = std::ranges::any_of(power_, [](double power) { return power > 0; });
  const bool heard = link_ && firmware_ && link_->shut(firmware_->panic());
  lost_at_work_ = lost_at_work_ || lit || moves_;
  {
    const std::lock_guard lock(panic_mutex_);
    panic_link_.reset();
  }
  firmware_.reset();
  link_.reset();
  std::ranges::fill(power_, 0.0);
  tell_guard();
  last_.reset();
  unheard_ = unheard_ || (lost_at_work_ && !heard);
  if (unheard_) {
    let_guard_seek();
  }
  return heard;
}

void Controller::tell_guard() {
  if (guard_) {
    guard_->lit(std::ranges::any_of(power_, [](double power) { return power > 0; }));
  }
}

void Controller::let_guard_seek() {
  if (!guard_ && ways_.guard) {
    guard_ = ways_.guard(panic_bytes_).value_or(nullptr);
  }
  if (guard_) {
    guard_->seek();
  }
}

Status Controller::settle(Status status) {
  if (status || status.error().kind != ErrorKind::kDevice) {
    return status;
  }
  if (link_ && link_->is_shut()) {
    return status;  // by an emergency stop, whose reset this may be: it waits, and finds out what is true
  }
  if (!drop() && lost_at_work_) {
    status.error().mend = kPullPlugs;
  }
  return status;
}

Controller::~Controller() {
  const std::lock_guard lock(mutex_);
  if (firmware_ && !firmware_->stop()) {
    drop();
    unheard_ = true;
  }
  if (unheard_ && guard_) {
    guard_->leave_it_to_you();
  }
}

Status Controller::gone() const {
  return lost_at_work_
             ? fail(ErrorKind::kDevice, "the controller cannot be reached, and its laser or its motor was on",
                    where_, kPullPlugs)
             : Status{};
}

std::unexpected<Error> Controller::stopped() const {
  return fail(ErrorKind::kCancelled, "stopped on the way", where_);
}

bool Controller::homes() const {
  return std::ranges::any_of(axes_, &Axis::can_home);
}

std::unexpected<Error> Controller::halted() const {
  return fail(ErrorKind::kUsage, "the emergency stop was pressed", where_,
              homes() ? "home the stage first" : "open the device anew");
}

Status Controller::plausible(const Position& now) {
  for (std::size_t k = 0; k < now.axes.size(); ++k) {
    const Axis& axis = firmware_->axes()[k];
    const double slack = std::max(kSlack * (axis.reach.second - axis.reach.first), 1.0);
    const bool beyond = firmware_->homed() && !axis.endless &&
                        (now.axes[k] < axis.reach.first - slack || now.axes[k] > axis.reach.second + slack);
    bool too_fast = false;
    if (last_ && !now.commanded) {
      const double seconds = static_cast<double>(now.timestamp_ns - last_->timestamp_ns + now.uncertainty_ns +
                                                 last_->uncertainty_ns) *
                             1e-9;
      too_fast = std::abs(now.axes[k] - last_->axes[k]) >
                 kSpeedSlack * axis.speed_maximum * (seconds + 0.05) + tolerance(axis);
    }
    if (!std::isfinite(now.axes[k]) || beyond || too_fast) {
      return fail(ErrorKind::kDevice, "the stage reports an impossible position: " + shown(axis, now.axes[k]),
                  where_, "see to its cable and motor, then home it");
    }
  }
  return {};
}

Result<Position> Controller::read_locked() {
  Result<Position> now = firmware_->read();
  if (!now) {
    return std::unexpected(settle(std::unexpected(now.error())).error());
  }
  if (const Status sane = settle(plausible(*now)); !sane) {
    return std::unexpected(sane.error());
  }
  moves_ = moves_ && now->moving;
  last_ = *now;
  return now;
}

Result<Controller::Motion> Controller::read() {
  const std::lock_guard lock(mutex_);
  if (const Status connected = connect(); !connected) {
    return std::unexpected(connected.error());
  }
  Result<Position> now = read_locked();
  if (!now) {
    return std::unexpected(now.error());
  }
  return Motion{std::move(*now), firmware_->homed(), power_};
}

Status Controller::set_laser(std::size_t laser, double power) {
  const std::lock_guard lock(mutex_);
  if (laser >= power_.size()) {
    return fail(ErrorKind::kUsage, "no laser " + std::to_string(laser), where_,
                "it has " + std::to_string(power_.size()) + ", from 0");
  }
  if (const Status connected = connect(); !connected) {
    return connected;
  }
  if (power > 0 && halted_) {
    return halted();
  }
  if (power > 0 && power < 1 && !firmware_->dims()) {
    return fail(ErrorKind::kUsage, "this controller has no power between off and on for its laser", where_,
                "give 0 or 1");
  }
  if (power <= 0 && firmware_->light_waits()) {
    const Result<Position> now = read_locked();
    if (!now) {
      return std::unexpected(now.error());
    }
    if (now->moving) {
      ++stops_;
      return end_locked();
    }
  }
  if (power > 0 && ways_.guard && !guard_) {
    Result<std::unique_ptr<Guard>> guard = ways_.guard(firmware_->panic());
    if (!guard) {
      return std::unexpected(guard.error());
    }
    guard_ = std::move(*guard);
  }
  const double before = power_[laser];
  power_[laser] = std::max(before, power);  // until it has answered it may be either
  tell_guard();
  Status set = settle(firmware_->set_laser(static_cast<int>(laser), power));
  if (set) {
    power_[laser] = power;
  } else if (set.error().kind == ErrorKind::kUsage) {
    power_[laser] = before;
  }
  tell_guard();
  return set;
}

Status Controller::move(std::size_t axis, double position, double speed, bool start_only) {
  const std::uint64_t stops = stops_;
  {
    const std::lock_guard lock(mutex_);
    if (axis >= axes_.size()) {
      return fail(ErrorKind::kUsage, "no axis " + std::to_string(axis), where_,
                  "it has " + std::to_string(axes_.size()) + ", from 0");
    }
    const Axis& one = axes_[axis];
    if (!(position >= one.minimum && position <= one.maximum)) {
      return fail(ErrorKind::kUsage, shown(one, position) + " is beyond the limits of axis " + one.name,
                  where_, "it goes from " + shown(one, one.minimum) + " to " + shown(one, one.maximum));
    }
    speed = speed > 0 ? speed : speed_share_ * one.speed_maximum;
    if (!(speed > 0 && speed <= one.speed_maximum * (1 + 1e-9))) {
      return fail(ErrorKind::kUsage, shown(one, speed) + "/s is no speed of axis " + one.name, where_,
                  "at most " + shown(one, one.speed_maximum) + "/s");
    }
    if (const Status connected = connect(); !connected) {
      return connected;
    }
    if (halted_) {
      return halted();
    }
    if (one.can_home && !firmware_->homed()) {
      return fail(ErrorKind::kUsage, "where the stage is is not known", where_, "home it first");
    }
    if (stops_ != stops) {
      return stopped();
    }
    Status started = firmware_->start_move(axis, position, speed);
    moves_ = moves_ || started || started.error().kind != ErrorKind::kUsage;
    if (started = settle(std::move(started)); !started) {
      return started;
    }
  }
  return start_only ? Status{} : wait_for(axis, position, speed, stops);
}

Status Controller::wait_for(std::size_t axis, double position, double speed, std::uint64_t stops) {
  Clock::time_point still_since = Clock::now();
  Clock::time_point until = Clock::time_point::max();
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (stops_ != stops || !firmware_) {
        return stopped();
      }
      const Result<Position> now = read_locked();
      if (!now) {
        return stops_ != stops ? stopped() : std::unexpected(now.error());
      }
      const double left = std::abs(now->axes[axis] - position);
      if (!now->moving && left <= tolerance(axes_[axis])) {
        return {};
      }
      if (until == Clock::time_point::max()) {
        until = Clock::now() + kGrace + duration_of(1.5 * left / speed);
      }
      still_since = now->moving ? Clock::now() : still_since;
      if (now->alarm || Clock::now() - still_since > kStandstill || Clock::now() > until) {
        if (Status ended = end_locked(); !ended) {
          return ended;
        }
        return fail(ErrorKind::kDevice,
                    (now->alarm ? "the stage went into alarm " : "the stage stands ") +
                        shown(axes_[axis], left) + " short of its target",
                    where_,
                    homes() ? "see what holds it up, then home it"
                            : "see what holds it up, then open the device anew");
      }
    }
    std::this_thread::sleep_for(kAskEvery);
  }
}

Status Controller::home() {
  const std::uint64_t stops = stops_;
  const std::lock_guard lock(mutex_);
  if (const Status connected = connect(); !connected) {
    return connected;
  }
  const Clock::time_point until = Clock::now() + ways_.homing;
  const bool moved = std::exchange(moves_, true);
  Status found = firmware_->home([&] { return stops_ != stops || Clock::now() > until; });
  if (!found && found.error().kind == ErrorKind::kCancelled && stops_ == stops) {
    found = fail(ErrorKind::kDevice, "the stage looked for its switch in vain", where_,
                 "see to its switch and its motor");
  }
  Status homed = settle(std::move(found));
  last_.reset();  // where it is may have been told anew
  if (homed) {
    moves_ = false;
    halted_ = halted_ && stops_ != stops;
  } else if (homed.error().kind == ErrorKind::kUsage) {  // a refusal that changes nothing
    moves_ = moved;
  } else if (homed.error().kind == ErrorKind::kCancelled && !link_->is_shut()) {
    moves_ = false;
    std::ranges::fill(power_, 0.0);
    tell_guard();
  }
  return homed;
}

Status Controller::stop() {
  ++stops_;
  const std::lock_guard lock(mutex_);
  return firmware_ ? end_locked() : gone();
}

Status Controller::end_locked() {
  return ended(firmware_->stop());
}

Status Controller::ended(Status status) {
  status = settle(std::move(status));
  if (status) {
    moves_ = false;
    std::ranges::fill(power_, 0.0);
    tell_guard();
  }
  last_.reset();
  return status;
}

Status Controller::emergency_stop() {
  const std::lock_guard one_at_a_time(halt_mutex_);
  ++stops_;
  halted_ = true;
  {  // first of all, whatever else goes on
    const std::lock_guard lock(panic_mutex_);
    if (panic_link_) {
      [[maybe_unused]] const Status sent = panic_link_->shut(panic_bytes_);
    }
  }
  const std::lock_guard lock(mutex_);
  halted_ = true;  // a homing that ended just then may have taken it back
  if (!firmware_) {
    return gone();
  }
  link_->open();
  return ended(firmware_->halt());
}

}  // namespace dubsar::usb_stage
