// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/grbl_protocol.h"

#include <charconv>
#include <utility>

#include "core/number_text.h"
#include "drivers/plugin.h"

namespace dubsar::usb_stage::grbl {

namespace {

constexpr std::size_t kMostAxes = 6;

std::optional<int> whole(std::string_view text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The part before a separator, which is taken off with it.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t at = text.find(separator);
  const std::string_view out = text.substr(0, at);
  text = at == text.npos ? std::string_view{} : text.substr(at + 1);
  return out;
}

std::optional<std::vector<double>> numbers(std::string_view text) {
  std::vector<double> out;
  while (!text.empty()) {
    const std::optional<double> value = plugin::number(cut(text, ','));
    if (!value || out.size() == kMostAxes) {
      return std::nullopt;
    }
    out.push_back(*value);
  }
  return out.empty() ? std::nullopt : std::optional(out);
}

std::optional<State> state_of(std::string_view word) {
  constexpr std::pair<std::string_view, State> kStates[] = {
      {"Idle", State::kIdle},   {"Run", State::kRun},     {"Hold", State::kHold},
      {"Jog", State::kJog},     {"Alarm", State::kAlarm}, {"Door", State::kDoor},
      {"Check", State::kCheck}, {"Home", State::kHome},   {"Sleep", State::kSleep}};
  for (const auto& [name, state] : kStates) {
    if (name == word) {
      return state;
    }
  }
  return std::nullopt;
}

Line report_from(std::string_view text) {
  Report out;
  std::string_view first = cut(text, '|');
  const std::optional<State> state = state_of(cut(first, ':'));
  if (!state) {
    return Other{};
  }
  out.state = *state;
  if (!first.empty()) {
    const std::optional<int> substate = whole(first);
    if (!substate) {
      return Other{};
    }
    out.substate = *substate;
  }
  while (!text.empty()) {
    std::string_view value = cut(text, '|');
    const std::string_view key = cut(value, ':');
    auto* to = key == "MPos"   ? &out.machine
               : key == "WPos" ? &out.work
               : key == "WCO"  ? &out.offset
                               : nullptr;
    if (to != nullptr) {
      *to = numbers(value);
      if (!*to) {
        return Other{};  // a position that is no position spoils the report
      }
    }
  }
  return out.machine || out.work ? Line(out) : Line(Other{});
}

}  // namespace

Line parse(std::string_view line) {
  if (line == "ok") {
    return Ok{};
  }
  if (line.size() > 1 && line.front() == '<' && line.back() == '>') {
    return report_from(line.substr(1, line.size() - 2));
  }
  if (line.starts_with("error:")) {
    const std::optional<int> code = whole(line.substr(6));
    return code ? Line(Fault{*code}) : Line(Other{});
  }
  if (line.starts_with("ALARM:")) {
    const std::optional<int> code = whole(line.substr(6));
    return code ? Line(Alarm{*code}) : Line(Other{});
  }
  if (line.starts_with("Grbl ")) {
    std::string_view rest = line.substr(5);
    return Banner{std::string(cut(rest, ' '))};
  }
  if (line.starts_with("$")) {
    std::string_view rest = line.substr(1);
    const std::optional<int> number = whole(cut(rest, '='));
    const std::optional<double> value = plugin::number(rest);
    return number && value ? Line(Setting{*number, *value}) : Line(Other{});
  }
  return Other{};
}

std::string meaning(const Fault& fault) {
  switch (fault.code) {
    case 5:
      return "homing is not enabled in its settings";
    case 8:
      return "it is moving";
    case 9:
      return "it is locked until it is homed";
    case 15:
      return "the target is beyond its own soft limits";
    case 22:
      return "no speed was given";
    default:
      return "error " + std::to_string(fault.code);
  }
}

std::string meaning(const Alarm& alarm) {
  switch (alarm.code) {
    case 1:
      return "it ran into a limit switch";
    case 2:
      return "the target is beyond its own soft limits";
    case 3:
      return "it was reset while it moved; its position is not certain";
    case 6:
    case 7:
    case 8:
    case 9:
      return "homing failed: a switch was not found or not left";
    default:
      return "alarm " + std::to_string(alarm.code);
  }
}

std::string move(char axis, double position, double per_minute) {
  return std::string("G90G21G53G1") + axis + fixed_text(position, 4) + "F" + fixed_text(per_minute, 3);
}

}  // namespace dubsar::usb_stage::grbl
