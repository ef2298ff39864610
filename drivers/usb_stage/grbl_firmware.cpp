// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <map>
#include <thread>

#include "core/number_text.h"
#include "drivers/usb_stage/firmware.h"
#include "drivers/usb_stage/grbl_protocol.h"
#include "drivers/usb_stage/line_talk.h"

namespace dubsar::usb_stage {

namespace {

using namespace std::chrono_literals;

/// A board that restarts when its line is opened needs a while.
constexpr auto kBoot = 3500ms;
constexpr auto kAskEvery = 500ms;
constexpr int kInches = 13;      // $13: reports in inches, whatever unit commands have
constexpr int kHoming = 22;      // $22
constexpr int kLaserScale = 30;  // $30: S of full power
constexpr int kSteps = 100;      // $100 + axis, per mm
constexpr int kRate = 110;       // $110 + axis, mm/min
constexpr int kTravel = 130;     // $130 + axis, mm

class Grbl : public Firmware {
 public:
  Grbl(Link& link, const std::vector<AxisWish>& wishes, const std::string& where)
      : talk_(link, where), wishes_(wishes) {
    dims_ = true;
  }

  Status connect() override {
    if (const Status reset = restart(); !reset) {
      return reset;
    }
    // Behind a reset the controller may say more; the settings end with ok.
    if (const Status listed = command("$$", kAnswer); !listed) {
      return listed;
    }
    axes_.clear();
    numbers_.clear();
    for (const AxisWish& wish : wishes_) {
      constexpr std::string_view kLetters = "xyzabc";
      const std::size_t number = kLetters.find(wish.name);
      if (wish.name.size() != 1 || number == kLetters.npos) {
        return fail(ErrorKind::kUsage, "no axis " + wish.name, talk_.where(), "axes are x, y, z, a, b and c");
      }
      const Axis axis = axis_of(wish, static_cast<int>(number));
      if (!(axis.minimum < axis.maximum) || !(axis.speed_maximum > 0)) {
        return bad_input(talk_.where(),
                         "the controller says that axis " + wish.name + " has no way or no speed",
                         "set its travel ($" + std::to_string(kTravel + number) + ") and its rate ($" +
                             std::to_string(kRate + number) + ") in the controller");
      }
      axes_.push_back(axis);
      numbers_.push_back(number);
    }
    homed_ = false;
    return homes() ? Status{} : unlock();
  }

  Status start_move(std::size_t axis, double position, double speed) override {
    const double unit = unit_of(axes_[axis].rotary);
    const char letter = static_cast<char>(axes_[axis].name[0] - 'a' + 'A');
    return command(grbl::move(letter, position / unit, speed / unit * 60), kAnswer);
  }

  Result<Position> read() override {
    const std::int64_t asked = now_ns();
    std::optional<grbl::Report> report;
    if (const Status got = ask(report); !got) {
      return std::unexpected(got.error());
    }
    const std::int64_t answered = now_ns();
    Position out;
    out.timestamp_ns = asked + (answered - asked) / 2;
    out.uncertainty_ns = (answered - asked) / 2;
    out.alarm = report->state == grbl::State::kAlarm;
    homed_ = homed_ && !out.alarm;
    // Before a report comes the planner may still hold what was just accepted: Idle is told too early by
    // none.
    out.moving = report->state == grbl::State::kRun || report->state == grbl::State::kJog ||
                 report->state == grbl::State::kHome ||
                 (report->state == grbl::State::kHold && report->substate != 0);
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const std::optional<double> machine = machine_position(*report, numbers_[k]);
      if (!machine) {
        return fail(ErrorKind::kDevice, "the controller reports fewer axes than it is said to have",
                    talk_.where(), "see the option axes=");
      }
      out.axes.push_back(*machine * unit_of(axes_[k].rotary));
    }
    return out;
  }

  Status set_laser(int /*laser*/, double power) override {
    // In laser mode ($32=1) M3 alone stays dark until a G1; without axes that moves nothing.
    if (power > 0) {
      return command("G1F1M3S" + fixed_text(power * laser_scale_, 3), kAnswer);
    }
    const Status off = command("M5", kAnswer);
    // One that is locked (in alarm) takes no M5. A reset puts the light off all the same, and it stands
    // still.
    return off || off.error().kind != ErrorKind::kUsage ? off : restart();
  }

  Status stop() override {
    std::optional<grbl::Report> report;
    if (const Status got = ask(report); !got) {
      return got;
    }
    if (report->state == grbl::State::kIdle) {
      return set_laser(0, 0);
    }
    if (report->state == grbl::State::kRun || report->state == grbl::State::kJog) {
      if (const Status held = talk_.write(std::string(1, grbl::kFeedHold)); !held) {
        return held;
      }
      const Clock::time_point until = Clock::now() + kAnswer;
      while (report->state != grbl::State::kIdle &&
             !(report->state == grbl::State::kHold && report->substate == 0)) {
        if (Clock::now() > until) {
          break;  // it brakes too long: the reset below ends it, at the price of its position
        }
        if (const Status got = ask(report); !got) {
          return got;
        }
      }
    }
    const bool gentle = report->state == grbl::State::kHold || report->state == grbl::State::kIdle;
    const bool was_homed = homed_;
    const Status reset = restart();
    homed_ = was_homed && gentle;
    return reset;
  }

  Status home(const Cancelled& cancelled) override {
    homed_ = false;
    if (const Status sent = talk_.send("$H"); !sent) {
      return sent;
    }
    // It may say nothing at all until it has found its switches: GRBL does not even answer `?`.
    for (;;) {
      if (cancelled()) {
        const Status reset = restart();
        return reset ? fail(ErrorKind::kCancelled, "stopped while it was homed", talk_.where()) : reset;
      }
      const Result<std::optional<std::string>> line = talk_.line(Clock::now() + 50ms);
      if (!line) {
        return std::unexpected(line.error());
      }
      if (!*line) {
        continue;
      }
      const grbl::Line said = grbl::parse(**line);
      if (std::holds_alternative<grbl::Banner>(said) && !cancelled()) {
        return lost_its_mind();
      }
      if (std::holds_alternative<grbl::Ok>(said)) {
        homed_ = true;
        return {};
      }
      if (const auto* fault = std::get_if<grbl::Fault>(&said)) {
        return fail(ErrorKind::kUsage, "cannot be homed: " + grbl::meaning(*fault), talk_.where());
      }
      if (const auto* alarm = std::get_if<grbl::Alarm>(&said)) {
        return fail(ErrorKind::kDevice, grbl::meaning(*alarm), talk_.where(), "see to its switches");
      }
    }
  }

  Status halt() override {
    homed_ = false;
    return restart();
  }

  [[nodiscard]] std::string panic() const override { return std::string(1, grbl::kSoftReset); }

 private:
  /// Resets the controller, which ends motion and light, and waits for its banner.
  Status restart() {
    talk_.forget();
    const Clock::time_point until = Clock::now() + kBoot;
    while (Clock::now() < until) {
      if (const Status sent = talk_.write(panic()); !sent) {
        return sent;
      }
      bool banner = false;
      const Clock::time_point next = std::min(Clock::now() + kAskEvery, until);
      while (!banner) {
        const Result<std::optional<std::string>> line = talk_.line(next);
        if (!line) {
          return std::unexpected(line.error());
        }
        if (!*line) {
          break;
        }
        const grbl::Line said = grbl::parse(**line);
        if (const auto* name = std::get_if<grbl::Banner>(&said)) {
          version_ = "Grbl " + name->version;
          banner = true;
        }
      }
      if (banner) {
        return let_it_finish();
      }
    }
    return talk_.silent();
  }

  /// A reset in motion leaves it in alarm, also over the next reset, and what has no switches is not homed.
  Status unlock() {
    std::optional<grbl::Report> report;
    if (const Status got = ask(report); !got) {
      return got;
    }
    return report->state == grbl::State::kAlarm ? command("$X", kAnswer) : Status{};
  }

  /// Whatever it still has to say about the reset comes at once; some go on for ever.
  Status let_it_finish() {
    const Clock::time_point enough = Clock::now() + 200ms;
    while (Clock::now() < enough) {
      const Result<std::optional<std::string>> more = talk_.line(Clock::now() + 20ms);
      if (!more) {
        return std::unexpected(more.error());
      }
      if (!*more) {
        break;
      }
    }
    return {};
  }

  /// A status report; other lines on the way are looked at as well.
  Status ask(std::optional<grbl::Report>& report) {
    report.reset();
    const Status answered = talk_.ask(grbl::kStatus, [&](const std::string& line) {
      const grbl::Line said = grbl::parse(line);
      if (const auto* got = std::get_if<grbl::Report>(&said)) {
        report = *got;
        if (got->offset) {
          offset_ = *got->offset;
        }
        return true;
      }
      homed_ = homed_ && !std::holds_alternative<grbl::Alarm>(said);
      return restarted(said);
    });
    return answered && restarted_ ? lost_its_mind() : answered;
  }

  /// A banner that nobody asked for: a reset by another thread's emergency stop, or a weak power supply.
  bool restarted(const grbl::Line& said) {
    const bool banner = std::holds_alternative<grbl::Banner>(said);
    homed_ = homed_ && !banner;
    restarted_ = restarted_ || banner;
    return banner;
  }
  [[nodiscard]] std::unexpected<Error> lost_its_mind() {
    restarted_ = false;
    return fail(ErrorKind::kDevice, "the controller restarted", talk_.where(),
                "see to its power, then home it");
  }

  /// A line that is answered with ok or error.
  Status command(const std::string& line, std::chrono::milliseconds wait) {
    if (const Status sent = talk_.send(line); !sent) {
      return sent;
    }
    std::optional<std::string> refused;
    const Status answered = talk_.until(Clock::now() + wait, [&](const std::string& text) {
      const grbl::Line said = grbl::parse(text);
      if (const auto* setting = std::get_if<grbl::Setting>(&said)) {
        settings_[setting->number] = setting->value;
      } else if (const auto* fault = std::get_if<grbl::Fault>(&said)) {
        refused = grbl::meaning(*fault);
      } else if (const auto* alarm = std::get_if<grbl::Alarm>(&said)) {
        homed_ = false;
        refused = grbl::meaning(*alarm);
      }
      return refused || std::holds_alternative<grbl::Ok>(said) || restarted(said);
    });
    if (answered && restarted_) {
      return lost_its_mind();
    }
    if (!answered || !refused) {
      return answered;
    }
    return fail(
        ErrorKind::kUsage, "the controller refuses " + line + ": " + *refused, talk_.where(),
        homes() ? "home it, or keep within its limits" : "keep within its limits, or open the device anew");
  }

  [[nodiscard]] bool homes() const { return setting(kHoming, 0) != 0; }

  [[nodiscard]] double setting(int number, double otherwise) const {
    const auto found = settings_.find(number);
    return found == settings_.end() ? otherwise : found->second;
  }

  [[nodiscard]] Axis axis_of(const AxisWish& wish, int number) {
    const double unit = unit_of(wish.rotary);
    laser_scale_ = setting(kLaserScale, 1000);
    Axis out;
    out.name = wish.name;
    out.rotary = wish.rotary;
    out.can_home = homes();
    const double travel = setting(kTravel + number, 200) * unit;
    // A homed GRBL counts from its switch downwards.
    out.minimum = wish.limits ? wish.limits->first * unit : -travel;
    out.maximum = wish.limits ? wish.limits->second * unit : out.can_home ? 0 : travel;
    out.reach = {std::min(out.minimum, -travel), std::max(out.maximum, travel)};
    out.speed_maximum = setting(kRate + number, 500) / 60 * unit;
    const double steps = setting(kSteps + number, 0);
    out.resolution = steps > 0 ? unit / steps : 0;
    return out;
  }

  [[nodiscard]] std::optional<double> machine_position(const grbl::Report& report, std::size_t axis) const {
    const auto& given = report.machine ? *report.machine : *report.work;
    if (axis >= given.size()) {
      return std::nullopt;
    }
    const double offset = report.machine || axis >= offset_.size() ? 0.0 : offset_[axis];
    return (given[axis] + offset) * (setting(kInches, 0) != 0 ? 25.4 : 1.0);
  }

  LineTalk talk_;
  std::vector<AxisWish> wishes_;
  std::vector<std::size_t> numbers_;  ///< of the axes, as the controller counts them
  std::map<int, double> settings_;
  std::vector<double> offset_;
  double laser_scale_ = 1000;
  bool restarted_ = false;
};

}  // namespace

std::unique_ptr<Firmware> make_grbl(Link& link, const std::vector<AxisWish>& axes, const std::string& where) {
  return std::make_unique<Grbl>(link, axes, where);
}

}  // namespace dubsar::usb_stage
