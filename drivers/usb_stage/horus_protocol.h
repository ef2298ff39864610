// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

/// What the firmware of Horus/Ciclop turntable scanners says: an older GRBL, with lasers and a light sensor
/// of its own. One axis in degrees.
namespace dubsar::usb_stage::horus {

struct Ok {};
struct Fault {
  std::string text;  ///< of `error: text`
};
struct Banner {
  std::string version;  ///< of `Horus 0.2 ['$' for help]`
};
struct Report {  ///< `<Idle,MPos:10.000,...>`
  bool moving = false;
  bool alarm = false;
  double degrees = 0;
};
struct Number {
  double value = 0;  ///< of a light sensor
};
struct Other {};

using Line = std::variant<Ok, Fault, Banner, Report, Number, Other>;

[[nodiscard]] Line parse(std::string_view line);

[[nodiscard]] std::string speed(double degrees_per_second);
[[nodiscard]] std::string move(double degrees);
/// Lasers count from 1.
[[nodiscard]] std::string laser(int number, bool on);

inline constexpr char kReset = 0x18;
inline constexpr char kStatus = '?';

}  // namespace dubsar::usb_stage::horus
