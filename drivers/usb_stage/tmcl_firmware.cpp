// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "drivers/usb_stage/firmware.h"
#include "drivers/usb_stage/tmcl_protocol.h"

namespace dubsar::usb_stage {

namespace {

using namespace std::chrono_literals;
using tmcl::AxisParameter;
using tmcl::Command;

constexpr std::uint8_t kAbsolute = 0;  // MVP ABS
constexpr std::uint8_t kStart = 0;     // RFS START, STOP, STATUS
constexpr std::uint8_t kStopSearch = 1;
constexpr std::uint8_t kSearchState = 2;
constexpr std::uint8_t kOutputBank = 2;  // SIO: digital outputs

class Tmcl : public Firmware {
 public:
  Tmcl(Link& link, const std::vector<AxisWish>& wishes, const TmclOptions& options, const std::string& where)
      : link_(link), wishes_(wishes), options_(options), where_(where) {}

  Status connect() override {
    if (options_.steps.size() != wishes_.size() || options_.speeds_max.size() != wishes_.size()) {
      return fail(ErrorKind::kUsage, "how far a step goes is not known", where_,
                  "give steps= (microsteps per mm or degree) and speed_max=, for each axis");
    }
    // One that turns goes round; one that does not would go on beyond its end.
    if (std::ranges::any_of(wishes_, [](const AxisWish& wish) { return !wish.rotary && !wish.limits; })) {
      return fail(ErrorKind::kUsage, "how far its axes may go is not known", where_,
                  "give limits= in mm for each axis that does not turn; own for one that does");
    }
    const Result<std::int32_t> version = ask({Command::kVersion, 1, 0, 0});
    if (!version) {
      return std::unexpected(version.error());
    }
    char text[32];
    std::snprintf(text, sizeof text, "TMCM-%u", static_cast<std::uint32_t>(*version) >> 16U);
    version_ = text;
    axes_.clear();
    for (std::size_t k = 0; k < wishes_.size(); ++k) {
      const AxisWish& wish = wishes_[k];
      const double unit = unit_of(wish.rotary);
      const double farthest = std::numeric_limits<std::int32_t>::max() / steps_per_unit(k);
      const double low = wish.limits ? wish.limits->first * unit : -farthest;
      const double high = wish.limits ? wish.limits->second * unit : farthest;
      // Its switch, or where it stands first, is at 0, within its limits or not.
      axes_.push_back({wish.name, wish.rotary, options_.switches, !wish.limits, low, high,
                       options_.speeds_max[k] * unit, 1 / steps_per_unit(k),
                       std::pair(std::min(low, 0.0), std::max(high, 0.0))});
    }
    homed_ = false;
    return stop();
  }

  Status start_move(std::size_t axis, double position, double speed) override {
    const auto motor = static_cast<std::uint8_t>(axis);
    const auto steps_per_second = static_cast<std::int32_t>(std::lround(speed * steps_per_unit(axis)));
    if (const auto set = ask({Command::kSetAxis, static_cast<std::uint8_t>(AxisParameter::kMaxSpeed), motor,
                              std::max(steps_per_second, 1)});
        !set) {
      return std::unexpected(set.error());
    }
    const double steps = std::round(position * steps_per_unit(axis));
    if (std::abs(steps) > std::numeric_limits<std::int32_t>::max()) {
      return fail(ErrorKind::kUsage, "farther than the motor can count", where_);
    }
    stopped_[axis] = false;
    const auto moved = ask({Command::kMoveTo, kAbsolute, motor, static_cast<std::int32_t>(steps)});
    return moved ? Status{} : std::unexpected(moved.error());
  }

  Result<Position> read() override {
    Position out;
    const std::int64_t asked = now_ns();
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      std::int32_t at = 0;
      std::int32_t speed = 0;
      std::int32_t target = 0;
      for (const auto& [parameter, to] :
           {std::pair(AxisParameter::kActual, &at), std::pair(AxisParameter::kActualSpeed, &speed),
            std::pair(AxisParameter::kTarget, &target)}) {
        const Result<std::int32_t> value = axis(parameter, k);
        if (!value) {
          return std::unexpected(value.error());
        }
        *to = *value;
      }
      out.axes.push_back(at / steps_per_unit(k));
      // Right after a move was asked for its speed is still 0; after a stop its target is behind it.
      out.moving = out.moving || speed != 0 || (target != at && !stopped_[k]);
    }
    const std::int64_t answered = now_ns();
    out.timestamp_ns = asked + (answered - asked) / 2;
    out.uncertainty_ns = (answered - asked) / 2;
    return out;
  }

  Status set_laser(int /*laser*/, double power) override {
    const auto set = ask({Command::kSetOutput, static_cast<std::uint8_t>(options_.laser_output), kOutputBank,
                          power > 0 ? 1 : 0});
    return set ? Status{} : std::unexpected(set.error());
  }

  [[nodiscard]] bool light_waits() const override { return false; }

  Status stop() override {
    if (const Status dark = set_laser(0, 0); !dark) {
      return dark;  // and no waiting for more answers: whoever gets this sends panic()
    }
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      if (const auto stopped = ask({Command::kMotorStop, 0, static_cast<std::uint8_t>(k), 0}); !stopped) {
        return std::unexpected(stopped.error());
      }
    }
    // With the target where it stands nothing can start again by itself.
    const Clock::time_point until = Clock::now() + kAnswer;
    for (std::size_t k = 0; k < axes_.size();) {
      const Result<std::int32_t> speed = axis(AxisParameter::kActualSpeed, k);
      if (!speed) {
        return std::unexpected(speed.error());
      }
      if (*speed != 0 && Clock::now() > until) {
        return fail(ErrorKind::kDevice, "the motor still turns", where_,
                    "see that it stands, or switch off its power");
      }
      k += *speed == 0 ? 1 : 0;
    }
    stopped_.assign(axes_.size(), true);
    return {};
  }

  Status home(const Cancelled& cancelled) override {
    if (!options_.switches) {
      return fail(ErrorKind::kUsage, "a stage without switches cannot be homed", where_,
                  "open it anew; it counts from where its controller was switched on");
    }
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const auto motor = static_cast<std::uint8_t>(k);
      if (const auto begun = ask({Command::kReference, kStart, motor, 0}); !begun) {
        return std::unexpected(begun.error());
      }
      for (;;) {
        if (cancelled()) {
          if (const auto ended = ask({Command::kReference, kStopSearch, motor, 0}); !ended) {
            return std::unexpected(ended.error());
          }
          const Status still = stop();
          return still ? fail(ErrorKind::kCancelled, "stopped while it was homed", where_) : still;
        }
        const Result<std::int32_t> state = ask({Command::kReference, kSearchState, motor, 0});
        if (!state) {
          return std::unexpected(state.error());
        }
        if (*state == 0) {
          break;
        }
      }
    }
    homed_ = true;
    stopped_.assign(axes_.size(), true);
    return {};
  }

  Status halt() override {
    homed_ = false;
    return stop();
  }

  [[nodiscard]] std::string panic() const override {
    std::string out =
        bytes({Command::kSetOutput, static_cast<std::uint8_t>(options_.laser_output), kOutputBank, 0});
    for (std::size_t k = 0; k < std::max<std::size_t>(axes_.size(), 1); ++k) {
      out += bytes({Command::kMotorStop, 0, static_cast<std::uint8_t>(k), 0});
    }
    return out;
  }

 private:
  /// Microsteps per mm or rad.
  [[nodiscard]] double steps_per_unit(std::size_t axis) const {
    return options_.steps[axis] / unit_of(wishes_[axis].rotary);
  }

  [[nodiscard]] std::string bytes(const tmcl::Request& request) const {
    const tmcl::Bytes encoded = tmcl::encode(request, static_cast<std::uint8_t>(options_.module));
    return {encoded.begin(), encoded.end()};
  }

  Result<std::int32_t> axis(AxisParameter parameter, std::size_t motor) {
    return ask(
        {Command::kGetAxis, static_cast<std::uint8_t>(parameter), static_cast<std::uint8_t>(motor), 0});
  }

  Result<std::int32_t> ask(const tmcl::Request& request) {
    if (const Status sent = link_.write(bytes(request)); !sent) {
      return std::unexpected(sent.error());
    }
    tmcl::ReplyFinder finder(request.command);
    const Clock::time_point until = Clock::now() + kAnswer;
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
      if (left.count() <= 0) {
        return fail(ErrorKind::kDevice, "the controller does not answer", where_,
                    "see to its power and cable, and that its laser is off");
      }
      const Result<std::string> got = link_.read(left);
      if (!got) {
        return std::unexpected(got.error());
      }
      const std::span all(reinterpret_cast<const std::uint8_t*>(got->data()), got->size());
      if (const std::optional<tmcl::Reply> reply = finder.add(all)) {
        if (!reply->good()) {
          return fail(ErrorKind::kDevice,
                      "the controller refuses command " + std::to_string(static_cast<int>(request.command)) +
                          ": " + tmcl::meaning(reply->status),
                      where_, "see that it is a motion module of Trinamic's");
        }
        return reply->value;
      }
    }
  }

  Link& link_;
  std::vector<AxisWish> wishes_;
  TmclOptions options_;
  std::string where_;
  std::vector<bool> stopped_;  ///< of each motor: its target is not where it goes
};

}  // namespace

std::unique_ptr<Firmware> make_tmcl(Link& link, const std::vector<AxisWish>& axes, const TmclOptions& options,
                                    const std::string& where) {
  return std::make_unique<Tmcl>(link, axes, options, where);
}

}  // namespace dubsar::usb_stage
