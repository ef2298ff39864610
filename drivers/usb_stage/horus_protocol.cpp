// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/horus_protocol.h"

#include <algorithm>

#include "core/number_text.h"
#include "drivers/plugin.h"

namespace dubsar::usb_stage::horus {

namespace {

Line report_from(std::string_view text) {
  const std::string_view state = text.substr(0, text.find(','));
  constexpr std::string_view kKnown[] = {"Idle", "Run", "Hold", "Home", "Alarm", "Check", "Queue", "Init"};
  if (std::ranges::find(kKnown, state) == std::end(kKnown)) {
    return Other{};
  }
  const std::size_t at = text.find("MPos:");
  if (at == text.npos) {
    return Other{};
  }
  const std::string_view rest = text.substr(at + 5);
  const std::optional<double> degrees = plugin::number(rest.substr(0, rest.find(',')));
  return degrees ? Line(Report{state != "Idle" && state != "Alarm", state == "Alarm", *degrees})
                 : Line(Other{});
}

}  // namespace

Line parse(std::string_view line) {
  if (line == "ok") {
    return Ok{};
  }
  if (line.starts_with("error:")) {
    std::string_view text = line.substr(6);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    return Fault{std::string(text)};
  }
  if (line.starts_with("Horus ")) {
    const std::string_view rest = line.substr(6);
    return Banner{std::string(rest.substr(0, rest.find(' ')))};
  }
  if (line.size() > 1 && line.front() == '<' && line.back() == '>') {
    return report_from(line.substr(1, line.size() - 2));
  }
  const std::optional<double> number = plugin::number(line);
  return number ? Line(Number{*number}) : Line(Other{});
}

std::string speed(double degrees_per_second) {
  return "G1F" + fixed_text(degrees_per_second, 3);
}

std::string move(double degrees) {
  return "G1X" + fixed_text(degrees, 4);
}

std::string laser(int number, bool on) {
  return (on ? "M71T" : "M70T") + std::to_string(number);
}

}  // namespace dubsar::usb_stage::horus
