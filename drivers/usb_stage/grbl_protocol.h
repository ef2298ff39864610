// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What GRBL 1.1 says, line by line (its interface document, "Grbl v1.1 Interface"). Pure text to values.
namespace dubsar::usb_stage::grbl {

enum class State { kIdle, kRun, kHold, kJog, kAlarm, kDoor, kCheck, kHome, kSleep };

/// `<Idle|MPos:0.000,0.000,0.000|FS:0,0|...>`. A report says MPos or WPos; the other one is found with WCO,
/// which comes now and then only.
struct Report {
  State state = State::kIdle;
  int substate = 0;  ///< of Hold and Door: 0 is "at rest"
  std::optional<std::vector<double>> machine, work, offset;
};

struct Ok {};
struct Fault {
  int code = 0;  ///< error:N
};
struct Alarm {
  int code = 0;  ///< ALARM:N
};
struct Banner {
  std::string version;  ///< of `Grbl 1.1h ['$' for help]`
};
struct Setting {
  int number = 0;  ///< $N=value
  double value = 0;
};
struct Other {};  ///< messages in brackets, start-up lines, garbage

using Line = std::variant<Ok, Fault, Alarm, Banner, Setting, Report, Other>;

[[nodiscard]] Line parse(std::string_view line);

/// What an error or alarm number means, for people; a number without a meaning gets a plain word.
[[nodiscard]] std::string meaning(const Fault& fault);
[[nodiscard]] std::string meaning(const Alarm& alarm);

/// `G90G21G53G1X10.0000F600.000`: a move in mm of the machine, whatever work offset is set, and mm per
/// minute.
[[nodiscard]] std::string move(char axis, double position, double per_minute);

inline constexpr char kSoftReset = 0x18;
inline constexpr char kFeedHold = '!';
inline constexpr char kStatus = '?';

}  // namespace dubsar::usb_stage::grbl
