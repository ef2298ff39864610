// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/drivers/peers/firmware_sims.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>
#include <vector>

#include "core/number_text.h"

namespace dubsar::test {

namespace {

/// The number that a text begins with, and what is behind it; no firmware knows of its host's locale.
std::pair<double, const char*> number(const char* text, const char* end) {
  double value = 0;
  return {value, std::from_chars(text, end, value).ptr};
}

/// GRBL 1.1: three axes of which x moves, a switch to home to, a laser that is obeyed behind the move that
/// runs, as is every line after it.
class GrblSim : public FirmwareSim {
 public:
  /// Without switches ($22=0) it wakes up unlocked, and cannot be homed.
  explicit GrblSim(bool homes) : homes_(homes) { power_up(); }
  void power_up() override {
    set(-3.5);  // it wakes up anywhere
    laser = 0;
    alarm_ = homes_;
    hold_ = homing_ = linear_ = false;
    line_.clear();
    queue_.clear();
    greet();
  }
  void take(std::string_view bytes, double now) override {
    finish_homing(now);
    finish_move(now);
    for (const char c : bytes) {
      switch (c) {
        case 0x18:
          reset(now);
          break;
        case '?':
          asked_ = true;
          report(now);
          break;
        case '!':
          if (moving(now)) {
            hold(now);
            hold_ = true;
          }
          break;
        case '~':
          hold_ = false;
          break;
        case '\r':
        case '\n':
          if (!line_.empty()) {
            queue_.push_back(line_);
          }
          line_.clear();
          finish_move(now);
          break;
        default:
          line_ += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      }
    }
  }

 private:
  void reset(double now) {
    alarm_ = alarm_ || moving(now) || homing_;
    hold(now);
    hold_ = homing_ = linear_ = false;
    laser = 0;
    line_.clear();
    queue_.clear();
    greet();
  }
  void greet() {
    out += "\r\nGrbl 1.1h ['$' for help]\r\n";
    if (alarm_) {
      out += "[MSG:'$H'|'$X' to unlock]\r\n";
    }
  }
  void finish_move(double now) {
    while (!queue_.empty() && !(moving(now) && queue_.front().contains('M'))) {
      const std::string line = queue_.front();
      queue_.erase(queue_.begin());
      run(line, now);
    }
  }
  void finish_homing(double now) {
    if (homing_ && now >= homed_at_) {
      homing_ = alarm_ = false;
      set(0);
      out += "ok\r\n";
      report(now);
    }
  }
  /// While it homes it is mute: who asked is answered afterwards, once.
  void report(double now) {
    if (homing_ || !asked_) {
      return;
    }
    asked_ = false;
    const char* state = alarm_ ? "Alarm" : hold_ ? "Hold:0" : moving(now) ? "Run" : "Idle";
    // The work offset comes with every tenth report, as the firmware does it.
    const bool offset = reports_++ % 10 == 0;
    out += std::string("<") + state + "|MPos:" + fixed_text(impossible ? 98765.4 : at(now), 3) +
           ",0.000,0.000|Bf:15,127|FS:0,0" + (offset ? "|WCO:5.000,0.000,0.000" : "") + ">\r\n";
  }
  void run(const std::string& line, double now) {
    if (line == "$$") {
      out += std::string("$22=") + (homes_ ? "1" : "0");
      out += "\r\n$30=1000\r\n$32=1\r\n$100=250.000\r\n$110=3000.000\r\n$130=200.000\r\nok\r\n";
    } else if (line == "$H" && !homes_) {
      out += "error:5\r\n";
    } else if (line == "$H") {
      homing_ = true;
      homed_at_ = now + 0.1;
    } else if (line == "$X") {
      alarm_ = false;
      out += "ok\r\n";
    } else if (alarm_ || homing_) {
      out += "error:9\r\n";
    } else {
      gcode(line, now);
    }
  }
  void gcode(const std::string& line, double now) {
    double x = NAN;
    double feed = 0;
    double power = 0;
    int light = -1;
    bool machine = false;
    const char* const line_end = line.data() + line.size();
    for (const char* at_char = line.data(); at_char != line_end;) {
      const char letter = *at_char++;
      const auto [value, end] = number(at_char, line_end);
      if (end == at_char || letter < 'A' || letter > 'Z') {
        out += "error:1\r\n";
        return;
      }
      at_char = end;
      machine = machine || (letter == 'G' && value == 53);
      linear_ = linear_ || (letter == 'G' && value == 1);
      x = letter == 'X' ? value : x;
      feed = letter == 'F' ? value : feed;
      power = letter == 'S' ? value : power;
      light = letter == 'M' ? static_cast<int>(value) : light;
    }
    if (light == 5) {
      laser = 0;
    } else if (light == 3) {
      laser = linear_ ? power / 1000 : 0;  // laser mode: dark until a G1
    }
    if (!std::isnan(x)) {
      const double target = machine ? x : x + 5;  // G54 stands 5 mm off
      if (feed <= 0 || target > 0 || target < -200) {
        out += feed <= 0 ? "error:22\r\n" : "error:15\r\n";
        return;
      }
      go(target, feed / 60, now);
    }
    out += "ok\r\n";
  }
  bool homes_;
  std::string line_;
  std::vector<std::string> queue_;  ///< whole lines that wait for the move
  bool alarm_ = true, hold_ = false, homing_ = false;
  bool linear_ = false;  ///< the motion mode is G1
  bool asked_ = false;   ///< for a report that was not given yet
  double homed_at_ = 0;
  int reports_ = 0;
};

/// Horus 0.2: a turntable in degrees, two lasers. Of its versions some answer `?`, and some say ok to a move
/// when it is accepted, others when the table stands.
class HorusSim : public FirmwareSim {
 public:
  HorusSim(bool reports, bool ok_at_end) : reports_(reports), ok_at_end_(ok_at_end) { power_up(); }
  void power_up() override { reset(); }
  void take(std::string_view bytes, double now) override {
    finish_move(now);
    for (const char c : bytes) {
      if (c == 0x18) {
        reset();
      } else if (c == '?') {
        const std::string shown = fixed_text(impossible ? 1e7 : at(now), 3);
        out += !reports_ ? ""
                         : (moving(now) ? "<Run,MPos:" : "<Idle,MPos:") + shown + ",WPos:" + shown + ">\r\n";
      } else if (c == '\r' || c == '\n') {
        if (!line_.empty()) {
          queue_.push_back(line_);
        }
        line_.clear();
        finish_move(now);
      } else if (c != ' ') {
        line_ += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      }
    }
  }

 private:
  void reset() {
    set(0);
    laser = lit_[0] = lit_[1] = 0;
    feed_ = 0;
    owes_ok_ = false;
    queue_.clear();
    line_.clear();
    out += "\r\nHorus 0.2 ['$' for help]\r\n";
  }
  /// Lines wait for the move before them, as do their answers; what is one character does not.
  void finish_move(double now) {
    if (owes_ok_ && !moving(now)) {
      owes_ok_ = false;
      out += "ok\r\n";
    }
    while (!owes_ok_ && !moving(now) && !queue_.empty()) {
      const std::string line = queue_.front();
      queue_.erase(queue_.begin());
      run(line, now);
    }
  }
  void run(const std::string& line, double now) {
    int tool = 0;
    const double value = line.size() > 3 ? number(line.data() + 3, line.data() + line.size()).first : 0;
    if (line.starts_with("G1F")) {
      feed_ = value;
    } else if (line.starts_with("G1X")) {
      if (feed_ == 0) {
        out += "error: Undefined feed rate\r\n";
        return;
      }
      go(value, feed_, now);
      owes_ok_ = ok_at_end_;
      if (owes_ok_) {
        return;
      }
    } else if (std::sscanf(line.c_str(), "M71T%d", &tool) == 1 && tool >= 1 && tool <= 2) {
      lit_[tool - 1] = 1;
    } else if (std::sscanf(line.c_str(), "M70T%d", &tool) == 1 && tool >= 1 && tool <= 2) {
      lit_[tool - 1] = 0;
    } else if (line != "M17" && line != "M18") {
      out += "error: Unsupported command\r\n";
      return;
    }
    laser = std::max(lit_[0], lit_[1]);
    out += "ok\r\n";
  }
  bool reports_, ok_at_end_;
  std::string line_;
  double feed_ = 0;
  double lit_[2] = {};
  bool owes_ok_ = false;
  std::vector<std::string> queue_;
};

/// A TMCM-6110 of a kind: motors 0 and 1 turn, output 0 is the laser. A motor that is stopped keeps its
/// target.
class TmclSim : public FirmwareSim {
 public:
  double brake_s = 0;  ///< how long motor 0 goes on when it is to stop
  void power_up() override {
    set(1234);
    laser = 0;
    bytes_.clear();
    second_ = {};
    motors_[0] = motors_[1] = {};
  }
  void take(std::string_view bytes, double now) override {
    bytes_.append(bytes);
    while (bytes_.size() >= 9) {
      answer(now);
      bytes_.erase(0, 9);
    }
  }

 private:
  void answer(double now) {
    const auto byte = [&](std::size_t k) { return static_cast<std::uint8_t>(bytes_[k]); };
    unsigned sum = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      sum += byte(k);
    }
    auto value = static_cast<std::int32_t>(std::uint32_t{byte(4)} << 24U | std::uint32_t{byte(5)} << 16U |
                                           std::uint32_t{byte(6)} << 8U | byte(7));
    std::uint8_t status = 100;
    if ((sum & 0xffU) != byte(8)) {
      status = 1;
    } else if (byte(1) == 136) {
      value = 0x17DE0100;
    } else if (byte(1) == 14) {  // its "motor" is a bank of outputs
      status = byte(3) == 2 && byte(2) < 8 ? 100 : 4;
      laser = status == 100 && byte(2) == 0 ? value : laser;
    } else if (byte(3) > 2) {
      status = 4;
    } else if (byte(3) < 2) {
      status = motor(byte(3), byte(1), byte(2), value, now);
    }
    const auto word = static_cast<std::uint32_t>(value);
    std::uint8_t reply[9] = {2,
                             byte(0),
                             status,
                             status == 1 ? std::uint8_t{0} : byte(1),
                             static_cast<std::uint8_t>(word >> 24U),
                             static_cast<std::uint8_t>(word >> 16U),
                             static_cast<std::uint8_t>(word >> 8U),
                             static_cast<std::uint8_t>(word),
                             0};
    reply[8] = static_cast<std::uint8_t>(std::accumulate(reply, reply + 8, 0U));
    out.append(reinterpret_cast<const char*>(reply), sizeof reply);
  }
  std::uint8_t motor(int which, std::uint8_t command, std::uint8_t type, std::int32_t& value, double now) {
    Motor& one = motors_[which];
    switch (command) {
      case 3:
        if (which == 1 || !std::exchange(brakes_, brake_s > 0)) {
          const double on = which == 0 && moving(now) ? brake_s * one.most : 0;
          drive(which, where(which, now) + std::copysign(on, target_ - at(now)), now);
        }
        return 100;
      case 4:
        one.target = value;
        brakes_ = brakes_ && which == 1;
        drive(which, value, now);
        return 100;
      case 5:
        one.most = type == 4 ? value : one.most;
        return 100;
      case 6:
        value = type == 0   ? one.target
                : type == 1 ? static_cast<std::int32_t>(impossible ? 2e9 : std::lround(where(which, now)))
                : type == 3 ? static_cast<std::int32_t>(turns(which, now) ? one.most : 0)
                            : 0;
        return 100;
      case 13:
        if (type == 0) {
          one.homing_until = now + 0.1;
        } else if (type == 1) {
          one.homing_until = -1;
        }
        if (one.homing_until >= 0 && now >= one.homing_until) {
          one.homing_until = -1;
          one.target = 0;
          which == 0 ? set(0) : static_cast<void>(second_ = {});
        }
        value = one.homing_until >= 0 ? 1 : 0;
        return 100;
      default:
        return 2;
    }
  }
  [[nodiscard]] double where(int which, double now) const { return which == 0 ? at(now) : second_.at(now); }
  [[nodiscard]] bool turns(int which, double now) const {
    return which == 0 ? moving(now) && !stuck : second_.at(now) != second_.target;
  }
  void drive(int which, double to, double now) {
    if (which == 0) {
      go(to, motors_[0].most, now);
    } else {
      second_ = {second_.at(now), to, motors_[1].most, now};
    }
  }
  struct Motor {
    std::int32_t target = 0;  ///< as it was asked for
    double most = 1000;
    double homing_until = -1;
  };
  bool brakes_ = false;  ///< motor 0: it is on its way to stand already
  std::string bytes_;
  Motor motors_[2];
  StageLaw second_;  ///< way of motor 1; that of motor 0 is the board's own
};

}  // namespace

std::unique_ptr<FirmwareSim> make_firmware_sim(const std::string& name) {
  if (name.starts_with("grbl")) {
    return std::make_unique<GrblSim>(name != "grbl-without-switches");
  }
  if (name.starts_with("horus")) {
    return std::make_unique<HorusSim>(name == "horus", name != "horus-silent-quick");
  }
  auto out = std::make_unique<TmclSim>();
  out->brake_s = name == "tmcl-heavy" ? 4 : 0;
  out->power_up();
  return out;
}

}  // namespace dubsar::test
