// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/drivers/peers/firmware_sims.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace dubsar::test {

namespace {

/// GRBL 1.1: three axes of which x moves, a switch to home to, a laser that is obeyed behind the move that
/// runs, as is every line after it.
class GrblSim : public FirmwareSim {
 public:
  GrblSim() { power_up(); }
  void power_up() override {
    set(-3.5);  // it wakes up anywhere
    laser = 0;
    alarm_ = true;
    hold_ = homing_ = linear_ = false;
    line_.clear();
    queue_.clear();
    out += "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n";
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
    char text[128];
    // The work offset comes with every tenth report, as the firmware does it.
    const bool offset = reports_++ % 10 == 0;
    std::snprintf(text, sizeof text, "<%s|MPos:%.3f,0.000,0.000|Bf:15,127|FS:0,0%s>\r\n", state,
                  impossible ? 98765.4 : at(now), offset ? "|WCO:5.000,0.000,0.000" : "");
    out += text;
  }
  void run(const std::string& line, double now) {
    if (line == "$$") {
      out += "$22=1\r\n$30=1000\r\n$32=1\r\n$100=250.000\r\n$110=3000.000\r\n$130=200.000\r\nok\r\n";
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
    for (const char* at_char = line.c_str(); *at_char != '\0';) {
      const char letter = *at_char++;
      char* end = nullptr;
      const double value = std::strtod(at_char, &end);
      if (end == at_char) {
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
  std::string line_;
  std::vector<std::string> queue_;  ///< whole lines that wait for the move
  bool alarm_ = true, hold_ = false, homing_ = false;
  bool linear_ = false;  ///< the motion mode is G1
  bool asked_ = false;   ///< for a report that was not given yet
  double homed_at_ = 0;
  int reports_ = 0;
};

/// Horus 0.2: a turntable in degrees, two lasers. A move's ok comes when the table stands.
class HorusSim : public FirmwareSim {
 public:
  HorusSim() { power_up(); }
  void power_up() override { reset(); }
  void take(std::string_view bytes, double now) override {
    finish_move(now);
    for (const char c : bytes) {
      if (c == 0x18) {
        reset();
      } else if (c == '?') {
        char text[96];
        const double shown = impossible ? 1e7 : at(now);
        std::snprintf(text, sizeof text, "<%s,MPos:%.3f,WPos:%.3f>\r\n", moving(now) ? "Run" : "Idle", shown,
                      shown);
        out += text;
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
    while (!owes_ok_ && !queue_.empty()) {
      const std::string line = queue_.front();
      queue_.erase(queue_.begin());
      run(line, now);
    }
  }
  void run(const std::string& line, double now) {
    int tool = 0;
    const double value = line.size() > 3 ? std::atof(line.c_str() + 3) : 0;
    if (line.starts_with("G1F")) {
      feed_ = value;
    } else if (line.starts_with("G1X")) {
      if (feed_ == 0) {
        out += "error: Undefined feed rate\r\n";
        return;
      }
      go(value, feed_, now);
      owes_ok_ = true;
      return;
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
  std::string line_;
  double feed_ = 0;
  double lit_[2] = {};
  bool owes_ok_ = false;
  std::vector<std::string> queue_;
};

/// A TMCM-6110 of a kind: motor 0 turns, output 0 is the laser.
class TmclSim : public FirmwareSim {
 public:
  void power_up() override {
    set(1234);
    laser = 0;
    bytes_.clear();
    homing_until_ = -1;
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
    } else if (byte(3) == 0) {
      status = motor(byte(1), byte(2), value, now);
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
  std::uint8_t motor(std::uint8_t command, std::uint8_t type, std::int32_t& value, double now) {
    switch (command) {
      case 3:
        hold(now);
        return 100;
      case 4:
        go(value, most_, now);
        return 100;
      case 5:
        most_ = type == 4 ? value : most_;
        return 100;
      case 6:
        value = type == 0   ? static_cast<std::int32_t>(target_)
                : type == 1 ? static_cast<std::int32_t>(impossible ? 2e9 : std::lround(at(now)))
                : type == 3 ? static_cast<std::int32_t>(moving(now) && !stuck ? most_ : 0)
                            : 0;
        return 100;
      case 13:
        if (type == 0) {
          homing_until_ = now + 0.1;
        } else if (type == 1) {
          homing_until_ = -1;
        }
        if (homing_until_ >= 0 && now >= homing_until_) {
          homing_until_ = -1;
          set(0);
        }
        value = homing_until_ >= 0 ? 1 : 0;
        return 100;
      default:
        return 2;
    }
  }
  std::string bytes_;
  double most_ = 1000;
  double homing_until_ = -1;
};

}  // namespace

std::unique_ptr<FirmwareSim> make_firmware_sim(const std::string& name) {
  if (name == "grbl") {
    return std::make_unique<GrblSim>();
  }
  if (name == "horus") {
    return std::make_unique<HorusSim>();
  }
  auto out = std::make_unique<TmclSim>();
  out->power_up();
  return out;
}

}  // namespace dubsar::test
