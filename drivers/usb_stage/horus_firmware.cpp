// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>

#include "drivers/usb_stage/firmware.h"
#include "drivers/usb_stage/horus_protocol.h"
#include "drivers/usb_stage/line_talk.h"

namespace dubsar::usb_stage {

namespace {

using namespace std::chrono_literals;

constexpr auto kBoot = 3500ms;  // of a board that restarts when its line is opened
constexpr auto kAskEvery = 500ms;
constexpr double kSpeedMaximum = rad_from_deg(500);
constexpr double kStep = rad_from_deg(0.1125);  // 200 steps, 16 microsteps
/// Far enough for any scan, near enough for four decimals in a float.
constexpr double kFarthestDeg = 100 * 360;

class Horus : public Firmware {
 public:
  Horus(Link& link, const std::vector<AxisWish>& wishes, const std::string& where)
      : talk_(link, where), wishes_(wishes) {
    lasers_ = 2;
  }

  Status connect() override {
    if (wishes_.size() != 1) {
      return fail(ErrorKind::kUsage, "a turntable has one axis", talk_.where(), "see the option axes=");
    }
    const auto limits = wishes_.front().limits.value_or(std::pair(-kFarthestDeg, kFarthestDeg));
    const auto [low, high] = std::pair(rad_from_deg(limits.first), rad_from_deg(limits.second));
    const bool endless = !wishes_.front().limits;
    // Where it stands at first is 0, within its limits or not.
    axes_ = {{wishes_.front().name, true, false, endless, low, high, kSpeedMaximum, kStep,
              std::pair(std::min(low, 0.0), std::max(high, 0.0))}};
    homed_ = true;  // a turntable: where it stands is its zero
    return begin_at(0);
  }

  Status start_move(std::size_t /*axis*/, double position, double speed) override {
    if (const Status set = command(horus::speed(deg_from_rad(speed))); !set) {
      return set;
    }
    // Its ok comes when the move is accepted in some versions and when it has ended in others: read() looks,
    // and goes by the time that the way takes where there is no report either.
    if (const Status sent = talk_.send(horus::move(deg_from_rad(position - zero_))); !sent) {
      return sent;
    }
    start_ = target_;
    target_ = position;
    move_begins_ = std::max(Clock::now(), move_ends_);
    move_ends_ = move_begins_ + duration_of(std::abs(target_ - start_) / speed);
    awaits_ok_ = true;
    return {};
  }

  Result<Position> read() override {
    Position out;
    const std::int64_t asked = now_ns();
    out.commanded = !reports_;
    std::optional<horus::Report> report;
    std::optional<std::string> refused;
    const auto take = [&](const std::string& line) {
      const horus::Line said = horus::parse(line);
      awaits_ok_ = awaits_ok_ && !std::holds_alternative<horus::Ok>(said);
      if (const auto* fault = std::get_if<horus::Fault>(&said)) {
        refused = fault->text;
      } else if (const auto* got = std::get_if<horus::Report>(&said)) {
        report = *got;
      }
      return refused || report || std::holds_alternative<horus::Banner>(said);
    };
    if (reports_) {
      if (const Status answered = talk_.ask(horus::kStatus, take); !answered) {
        return std::unexpected(answered.error());
      }
    } else if (awaits_ok_) {
      const Result<std::optional<std::string>> line = talk_.line(Clock::now() + 20ms);
      if (!line) {
        return std::unexpected(line.error());
      }
      take(line->value_or(""));
    }
    if (refused) {
      awaits_ok_ = false;
      return fail(ErrorKind::kDevice, "the controller refuses to move: " + *refused, talk_.where());
    }
    if (reports_ && !report) {
      return fail(ErrorKind::kDevice, "the controller restarted", talk_.where(), "see to its power");
    }
    const std::int64_t answered = now_ns();
    out.timestamp_ns = asked + (answered - asked) / 2;
    out.uncertainty_ns = (answered - asked) / 2;
    out.moving = awaits_ok_ || (report ? report->moving : Clock::now() < move_ends_);
    out.alarm = report && report->alarm;
    out.axes = {report ? zero_ + rad_from_deg(report->degrees) : asked_for_now()};
    return out;
  }

  Status set_laser(int laser, double power) override { return command(horus::laser(laser + 1, power > 0)); }

  /// This firmware has no way to brake: a reset ends the motion, and its own count begins at 0 there.
  Status stop() override {
    const Result<Position> now = read();
    if (!now) {
      return std::unexpected(now.error());
    }
    if (now->moving) {
      return begin_at(now->axes.front());
    }
    for (int laser = 0; laser < lasers_; ++laser) {
      if (const Status off = set_laser(laser, 0); !off) {
        return off;
      }
    }
    return {};
  }

  Status home(const Cancelled& /*cancelled*/) override {
    return fail(ErrorKind::kUsage, "a turntable without a switch cannot be homed", talk_.where(),
                "where it stands when it is opened is its zero");
  }

  /// The bytes of panic() have reset it already: what it reports no longer tells where that was.
  Status halt() override { return begin_at(asked_for_now()); }

  [[nodiscard]] std::string panic() const override { return "\x18\r\nM70T1\r\nM70T2\r\nM18\r\n"; }

 private:
  /// Along the way of the last move.
  [[nodiscard]] double asked_for_now() const {
    const std::chrono::duration<double> whole = move_ends_ - move_begins_;
    const std::chrono::duration<double> gone = Clock::now() - move_begins_;
    return gone < whole ? start_ + (target_ - start_) * std::max(gone / whole, 0.0) : target_;
  }

  /// Restarts it, dark, where it stands at `position`, rad: there its limits stay as they are.
  Status begin_at(double position) {
    zero_ = position;
    if (const Status reset = restart(); !reset) {
      return reset;
    }
    for (int laser = 1; laser <= lasers_; ++laser) {
      if (const Status off = command(horus::laser(laser, false)); !off) {
        return off;
      }
    }
    return command("M17");
  }

  Status restart() {
    talk_.forget();
    awaits_ok_ = false;
    start_ = target_ = zero_;
    move_begins_ = move_ends_ = {};
    const Clock::time_point until = Clock::now() + kBoot;
    while (Clock::now() < until) {
      if (const Status sent = talk_.send(std::string(1, horus::kReset) + "\r"); !sent) {
        return sent;
      }
      const Clock::time_point next = std::min(Clock::now() + kAskEvery, until);
      for (bool listening = true; listening;) {
        const Result<std::optional<std::string>> line = talk_.line(next);
        if (!line) {
          return std::unexpected(line.error());
        }
        listening = line->has_value();
        const horus::Line said = horus::parse(line->value_or(""));
        if (const auto* banner = std::get_if<horus::Banner>(&said)) {
          version_ = "Horus " + banner->version;
          return find_out_whether_it_reports();
        }
      }
    }
    return talk_.silent();
  }

  Status find_out_whether_it_reports() {
    if (const Status sent = talk_.write(std::string(1, horus::kStatus)); !sent) {
      return sent;
    }
    reports_ = false;
    const Clock::time_point until = Clock::now() + 200ms;
    for (;;) {
      const Result<std::optional<std::string>> line = talk_.line(until);
      if (!line) {
        return std::unexpected(line.error());
      }
      if (!*line) {
        return {};
      }
      if (std::holds_alternative<horus::Report>(horus::parse(**line))) {
        reports_ = true;
        return {};
      }
    }
  }

  Status command(const std::string& line) {
    if (const Status sent = talk_.send(line + "\r"); !sent) {
      return sent;
    }
    std::optional<std::string> refused;
    // Answers come in order: that to a move which is still on its way stands before ours.
    const Clock::time_point until = std::max(Clock::now(), move_ends_) + kAnswer;
    const Status answered = talk_.until(until, [&](const std::string& text) {
      const horus::Line said = horus::parse(text);
      if (std::holds_alternative<horus::Ok>(said) && awaits_ok_) {
        awaits_ok_ = false;
        return false;
      }
      if (const auto* fault = std::get_if<horus::Fault>(&said)) {
        refused = fault->text;
      }
      return refused || std::holds_alternative<horus::Ok>(said);
    });
    if (!answered || !refused) {
      return answered;
    }
    return fail(ErrorKind::kDevice, "the controller refuses " + line + ": " + *refused, talk_.where());
  }

  LineTalk talk_;
  std::vector<AxisWish> wishes_;
  bool reports_ = false;
  bool awaits_ok_ = false;
  double zero_ = 0;                                ///< where its own count is 0, rad
  double start_ = 0, target_ = 0;                  ///< of the last move
  Clock::time_point move_begins_{}, move_ends_{};  ///< as its speed has it
};

}  // namespace

std::unique_ptr<Firmware> make_horus(Link& link, const std::vector<AxisWish>& axes,
                                     const std::string& where) {
  return std::make_unique<Horus>(link, axes, where);
}

}  // namespace dubsar::usb_stage
