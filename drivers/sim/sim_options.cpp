// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/sim/sim_options.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace dubsar::sim_driver {

namespace {

using plugin::SettingRow;

const SettingRow kRows[] = {
    {DUBSAR_TYPE_INTEGER, "seed", "of tablet, noise, pins and hands", nullptr, nullptr, 0,
     9007199254740992.0},
    {DUBSAR_TYPE_TEXT, "size", "of the tablet, WxHxT, each 5 to 300", "mm"},
    {DUBSAR_TYPE_NUMBER, "spacing", "lateral spacing of the samples", "mm", nullptr, 0.01, 5},
    {DUBSAR_TYPE_NUMBER, "noise", "of the depth, one standard deviation", "mm", nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "mesh_spacing", "edge length of the true surface; without it that of the samples",
     "mm", nullptr, 0.01, 5},
    {DUBSAR_TYPE_TEXT, "tablet", "a mesh file to be scanned instead of a made-up tablet"},
    {DUBSAR_TYPE_BOOL, "pins", "1: fifteen fiducial pins stand around the tablet", nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "text", "share of the room for text that is written on", nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "damage", "fractures, erosion, dirt and cracks, from none to badly", nullptr,
     nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "holes", "firing holes, from none to many", nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_TEXT, "truth", "a folder that gets the truth: poses, pins and the surface"},
};

std::unexpected<Error> refuse(const SettingRow& row, std::string_view value) {
  std::string takes = row.help;
  if (row.minimum <= row.maximum) {
    char range[64];
    std::snprintf(range, sizeof range, " (%g to %g)", row.minimum, row.maximum);
    takes += range;
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
    if (row->type == DUBSAR_TYPE_TEXT) {
      if (value.empty()) {
        return refuse(*row, value);
      }
      if (key == "tablet") {
        out.tablet_file = value;
      } else if (key == "truth") {
        out.truth_folder = value;
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
