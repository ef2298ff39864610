// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/usb_stage/options.h"

#include <algorithm>
#include <functional>

namespace dubsar::usb_stage {

namespace {

constexpr std::array<plugin::SettingRow, 8> kRows{{
    {DUBSAR_TYPE_CHOICE, "firmware", "what the controller speaks; auto tells grbl and horus by their banner",
     nullptr, "auto|grbl|horus|tmcl"},
    {DUBSAR_TYPE_TEXT, "axes",
     "its axes in their order, those that turn with :deg, e.g. x,y:deg; default: x"},
    {DUBSAR_TYPE_TEXT, "limits",
     "soft limits of each axis, e.g. 0..120,-90..90; own or default: the controller's, tmcl has none",
     "mm or deg"},
    {DUBSAR_TYPE_TEXT, "steps",
     "of tmcl: microsteps per mm, or per degree; one for all axes or one for each, e.g. 1600,88.9"},
    {DUBSAR_TYPE_TEXT, "speed_max", "of tmcl: the greatest speed; one for all axes or one for each",
     "mm/s or deg/s"},
    {DUBSAR_TYPE_INTEGER, "module", "of tmcl: the module's address", nullptr, nullptr, 1, 255},
    {DUBSAR_TYPE_INTEGER, "laser_output", "of tmcl: the digital output that the laser hangs on", nullptr,
     nullptr, 0, 7},
    {DUBSAR_TYPE_CHOICE, "switches",
     "of tmcl: whether its axes have reference switches to home to; default: yes", nullptr, "yes|no"},
}};

/// The parts between commas.
std::vector<std::string_view> parts(std::string_view text) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t comma = text.find(',');
    out.push_back(text.substr(0, comma));
    if (comma == text.npos) {
      return out;
    }
    text.remove_prefix(comma + 1);
  }
}

bool take_axes(std::string_view text, std::vector<AxisWish>& axes) {
  axes.clear();
  for (std::string_view part : parts(text)) {
    AxisWish wish;
    if (part.ends_with(":deg")) {
      wish.rotary = true;
      part.remove_suffix(4);
    } else if (part.ends_with(":mm")) {
      part.remove_suffix(3);
    }
    wish.name = std::string(part);
    const bool letter = part.size() == 1 && std::string_view("xyzabc").contains(part[0]);
    if (!letter || std::ranges::find(axes, wish.name, &AxisWish::name) != axes.end()) {
      return false;
    }
    axes.push_back(wish);
  }
  return true;
}

using Limits = std::optional<std::pair<double, double>>;

/// Nothing for an axis that has its controller's own.
bool take_limits(std::string_view text, std::vector<Limits>& limits) {
  for (const std::string_view part : parts(text)) {
    if (part == "own") {
      limits.emplace_back();
      continue;
    }
    const std::size_t dots = part.find("..");
    const auto low = plugin::number(part.substr(0, dots));
    const auto high = dots == part.npos ? std::nullopt : plugin::number(part.substr(dots + 2));
    if (!low || !high || !(*low < *high)) {
      return false;
    }
    limits.emplace_back(std::pair(*low, *high));
  }
  return true;
}

/// Numbers above 0 that a motor may have.
bool take_list(std::string_view text, std::vector<double>& numbers) {
  numbers.clear();
  for (const std::string_view part : parts(text)) {
    const std::optional<double> value = plugin::number(part);
    if (!value || !(*value >= 1e-6 && *value <= 1e9)) {
      return false;
    }
    numbers.push_back(*value);
  }
  return true;
}

/// One for each axis. False when one is to serve both mm and degrees, or there are more or fewer.
bool spread(const std::vector<AxisWish>& axes, std::vector<double>& numbers) {
  const bool mixed = std::ranges::adjacent_find(axes, std::not_equal_to{}, &AxisWish::rotary) != axes.end();
  if (numbers.size() == 1 && !mixed) {
    numbers.resize(axes.size(), numbers.front());
  }
  return numbers.empty() || numbers.size() == axes.size();
}

/// A number within the range of its row.
bool take_number(std::string_view text, const plugin::SettingRow& row, double& to) {
  const std::optional<double> value = plugin::number(text);
  if (!value || *value < row.minimum || *value > row.maximum) {
    return false;
  }
  to = *value;
  return row.type != DUBSAR_TYPE_INTEGER || *value == static_cast<double>(static_cast<int>(*value));
}

}  // namespace

std::span<const plugin::SettingRow> option_rows() {
  return kRows;
}

Result<StageOptions> parse_options(std::span<const dubsar_option> options) {
  StageOptions out;
  std::vector<Limits> limits;
  double module = 1;
  double output = 0;
  for (const dubsar_option& option : options) {
    const std::string_view key = option.key;
    const std::string_view value = option.value;
    const auto row = std::ranges::find(kRows, key, &plugin::SettingRow::key);
    if (row == kRows.end()) {
      continue;  // who loads drivers passes none that there is not
    }
    bool good = true;
    if (key == "firmware") {
      good = value == "auto" || value == "grbl" || value == "horus" || value == "tmcl";
      out.firmware = value;
    } else if (key == "axes") {
      good = take_axes(value, out.axes);
    } else if (key == "limits") {
      good = take_limits(value, limits);
    } else if (key == "steps") {
      good = take_list(value, out.tmcl.steps);
    } else if (key == "speed_max") {
      good = take_list(value, out.tmcl.speeds_max);
    } else if (key == "switches") {
      good = value == "yes" || value == "no";
      out.tmcl.switches = value != "no";
    } else {
      good = take_number(value, *row, key == "module" ? module : output);
    }
    if (!good) {
      return plugin::not_understood(*row, value);
    }
  }
  if (!limits.empty() && limits.size() != out.axes.size()) {
    return fail(
        ErrorKind::kUsage,
        "limits for " + std::to_string(limits.size()) + " of " + std::to_string(out.axes.size()) + " axes",
        {}, "give limits= for each axis of axes=, or for none");
  }
  for (std::size_t k = 0; k < limits.size(); ++k) {
    out.axes[k].limits = limits[k];
  }
  if (!spread(out.axes, out.tmcl.steps) || !spread(out.axes, out.tmcl.speeds_max)) {
    return fail(ErrorKind::kUsage,
                "steps= and speed_max= do not fit the " + std::to_string(out.axes.size()) + " axes", {},
                "give one for each axis of axes=; one for all serves where all are mm or all degrees");
  }
  out.tmcl.module = static_cast<int>(module);
  out.tmcl.laser_output = static_cast<int>(output);
  return out;
}

}  // namespace dubsar::usb_stage
