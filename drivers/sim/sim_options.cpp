// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/sim/sim_options.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/number_text.h"

namespace dubsar::sim_driver {

namespace {

using plugin::SettingRow;

const SettingRow kRows[] = {
    {DUBSAR_TYPE_INTEGER, "seed", "of tablet, noise, pins and hands; default: 1", nullptr, nullptr, 0,
     9007199254740992.0},
    {DUBSAR_TYPE_TEXT, "size", "of the tablet, WxHxT, each 5 to 300; default: 50x40x20", "mm"},
    {DUBSAR_TYPE_NUMBER, "spacing", "lateral spacing of the samples; default: 0.1", "mm", nullptr, 0.01, 5},
    {DUBSAR_TYPE_NUMBER, "noise", "of the depth, one standard deviation; default: 0.02", "mm", nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "mesh_spacing", "edge length of the true surface; default: that of the samples",
     "mm", nullptr, 0.01, 5},
    {DUBSAR_TYPE_TEXT, "tablet", "a mesh file to be scanned instead of a made-up tablet"},
    {DUBSAR_TYPE_BOOL, "pins", "1: fifteen fiducial pins stand around the tablet; default: 0", nullptr,
     nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "text", "share of the room for text that is written on; default: 1", nullptr,
     nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "damage", "fractures, erosion, dirt and cracks, from none to badly; default: 0.3",
     nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_CHOICE, "motion", "what is driven; default: turntable", nullptr, "turntable|robot"},
    {DUBSAR_TYPE_NUMBER, "move_time", "that a move takes; default: 0", "s", nullptr, 0, 600},
    {DUBSAR_TYPE_INTEGER, "fail_move_at", "this move, from 0, ends half way with a fault", nullptr, nullptr,
     0, 1e6},
    {DUBSAR_TYPE_INTEGER, "stop_at", "this scan, from 0, ends in the middle with a fault", nullptr, nullptr,
     0, 1e6},
    {DUBSAR_TYPE_INTEGER, "stop_rows", "rows of the scan that stops; default: 30", nullptr, nullptr, 0, 1e6},
    {DUBSAR_TYPE_TEXT, "intrude",
     "hand@N (over half of the tablet), glove@N (over all of it), grip@N (fingers at its edge) or gone@N "
     "(the "
     "tablet is away): in scan N, from 0, in N-M, or in each Kth of these, N-M/K"},
    {DUBSAR_TYPE_INTEGER, "swap_at", "another tablet lies there from this scan on", nullptr, nullptr, 0, 1e6},
    {DUBSAR_TYPE_NUMBER, "holes", "firing holes, from none to many; default: 0", nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_TEXT, "truth", "a folder that gets the truth: poses, pins and the surface"},
};

std::unexpected<Error> refuse(const SettingRow& row, std::string_view value) {
  std::string takes = row.help;
  if (row.choices != nullptr) {
    takes += std::string(" (") + row.choices + ")";
  }
  if (row.minimum <= row.maximum) {
    takes += " (" + short_text(row.minimum) + " to " + short_text(row.maximum) + ")";
  }
  return fail(ErrorKind::kUsage, "option " + std::string(row.key) + " cannot be '" + std::string(value) + "'",
              "sim:", "it is " + takes);
}

/// "50x40x20"
std::optional<Eigen::Vector3d> size_of(std::string_view text) {
  Eigen::Vector3d size;
  for (int k = 0; k < 3; ++k) {
    const std::size_t end = k < 2 ? text.find('x') : text.size();
    const std::optional<double> number =
        end == std::string_view::npos ? std::nullopt : plugin::number(text.substr(0, end));
    if (!number || *number < 5 || *number > 300) {
      return std::nullopt;
    }
    size[k] = *number;
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return size;
}

std::optional<int> count_of(std::string_view text) {
  const std::optional<double> number = plugin::number(text);
  return number && *number >= 0 && *number <= 1e6 && *number == std::floor(*number)
             ? std::optional(static_cast<int>(*number))
             : std::nullopt;
}

/// "hand@3", "gone@2-4", "grip@1-30/3"
bool take_intrusion(std::string_view text, SimOptions& out) {
  const std::size_t at = text.find('@');
  const std::string_view what = text.substr(0, at);
  out.intrude = what == "hand"    ? sim::Disturbance::kHand
                : what == "glove" ? sim::Disturbance::kGlove
                : what == "grip"  ? sim::Disturbance::kGrip
                : what == "gone"  ? sim::Disturbance::kGone
                                  : sim::Disturbance::kNone;
  if (out.intrude == sim::Disturbance::kNone || at == std::string_view::npos) {
    return false;
  }
  const std::size_t slash = text.find('/', at);
  const std::string_view scans = text.substr(at + 1, slash - (at + 1));
  const std::optional<int> every = slash == std::string_view::npos ? 1 : count_of(text.substr(slash + 1));
  const std::size_t dash = scans.find('-');
  const std::optional<int> first = count_of(scans.substr(0, dash));
  const std::optional<int> last = dash == std::string_view::npos ? first : count_of(scans.substr(dash + 1));
  if (!first || !last || *last < *first || !every || *every < 1) {
    return false;
  }
  out.intrude_at = *first;
  out.intrude_until = *last;
  out.intrude_every = *every;
  return true;
}

}  // namespace

std::span<const SettingRow> option_rows() {
  return kRows;
}

Result<SimOptions> parse_options(std::span<const dubsar_option> options) {
  SimOptions out;
  double mesh_spacing = 0;
  std::uint64_t seed = 1;
  bool pins = false;
  for (const dubsar_option& option : options) {
    const std::string_view value = option.value;
    const auto* row = std::ranges::find(kRows, std::string_view(option.key),
                                        [](const SettingRow& one) { return std::string_view(one.key); });
    if (row == std::end(kRows)) {
      return fail(ErrorKind::kUsage, "no option " + std::string(option.key), "sim:");
    }
    const std::string_view key = row->key;
    if (key == "motion") {
      if (value != "turntable" && value != "robot") {
        return refuse(*row, value);
      }
      out.station.robot = value == "robot";
      continue;
    }
    if (row->type == DUBSAR_TYPE_TEXT) {
      if (value.empty()) {
        return refuse(*row, value);
      }
      if (key == "tablet") {
        out.tablet_file = value;
      } else if (key == "truth") {
        out.truth_folder = value;
      } else if (key == "intrude") {
        if (!take_intrusion(value, out)) {
          return refuse(*row, value);
        }
      } else if (const std::optional<Eigen::Vector3d> size = size_of(value)) {
        out.tablet.size_mm = *size;
      } else {
        return refuse(*row, value);
      }
      continue;
    }
    const std::optional<double> number = plugin::number(value);
    if (!number || *number < row->minimum || *number > row->maximum ||
        (row->type != DUBSAR_TYPE_NUMBER && *number != std::floor(*number))) {
      return refuse(*row, value);
    }
    if (key == "seed") {
      seed = static_cast<std::uint64_t>(*number);
    } else if (key == "spacing") {
      out.station.scanner.spacing_mm = *number;
    } else if (key == "noise") {
      out.station.scanner.noise_mm = *number;
    } else if (key == "mesh_spacing") {
      mesh_spacing = *number;
    } else if (key == "pins") {
      pins = *number != 0;
    } else if (key == "move_time") {
      out.move_time_s = *number;
    } else if (key == "fail_move_at") {
      out.fail_move_at = static_cast<int>(*number);
    } else if (key == "stop_at") {
      out.stop_at = static_cast<int>(*number);
    } else if (key == "stop_rows") {
      out.stop_rows = static_cast<int>(*number);
    } else if (key == "swap_at") {
      out.swap_at = static_cast<int>(*number);
    } else if (key == "text") {
      out.tablet.text_density = *number;
    } else if (key == "damage") {
      out.tablet.damage = {*number, *number, *number, *number, out.tablet.damage.holes};
    } else if (key == "holes") {
      out.tablet.damage.holes = *number;
    }
  }
  out.tablet.seed = seed;
  out.tablet.spacing_mm = mesh_spacing > 0 ? mesh_spacing : out.station.scanner.spacing_mm;
  out.station.seed = seed;
  out.station.scanner.seed = seed;
  if (pins) {
    out.station.pins.emplace();
    out.station.pins->seed = seed;
  }
  return out;
}

}  // namespace dubsar::sim_driver
