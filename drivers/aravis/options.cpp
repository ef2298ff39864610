// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/options.h"

#include <algorithm>
#include <array>

namespace dubsar::aravis {

namespace {

constexpr std::array<plugin::SettingRow, 10> kRows{{
    {DUBSAR_TYPE_TEXT, "format",
     "pixel format by its GenICam name, e.g. Mono8 or Coord3D_AC16; default: the best"},
    {DUBSAR_TYPE_INTEGER, "buffers", "frames in the pool; default: half a second of them, 256 MiB at most",
     nullptr, nullptr, 2, 256},
    {DUBSAR_TYPE_INTEGER, "packet", "size of GigE packets; default: what the network carries", "bytes",
     nullptr, 576, 16000},
    {DUBSAR_TYPE_BOOL, "resend", "ask for lost packets again; default: 1", nullptr, nullptr, 0, 1},
    {DUBSAR_TYPE_BOOL, "raw_socket",
     "take packets before the kernel's own network stack, where that is allowed; default: 1", nullptr,
     nullptr, 0, 1},
    {DUBSAR_TYPE_INTEGER, "rows", "of range cameras: profiles in a scan; default: 1000", nullptr, nullptr, 1,
     1000000},
    {DUBSAR_TYPE_NUMBER, "row", "of range cameras: motion from row to row; default: the camera's scale of B",
     "mm", nullptr, -100, 100},
    {DUBSAR_TYPE_NUMBER, "count",
     "of range cameras: motion for a count of the encoder; default: rows are evenly spaced", "mm", nullptr,
     -100, 100},
    {DUBSAR_TYPE_BOOL, "flip", "of range cameras: C grows away from the scanner; default: 0", nullptr,
     nullptr, 0, 1},
    {DUBSAR_TYPE_NUMBER, "wait", "of range cameras: for the next profiles; default: 1.5", "s", nullptr, 0.1,
     600},
}};

/// False: the option does not take this value.
bool take(const plugin::SettingRow& row, const dubsar_option& option, CameraOptions& out) {
  const std::string_view key = row.key;
  if (key == "format") {
    out.format = option.value;
    return !out.format.empty() && out.format.size() < 64;
  }
  const std::optional<double> value = plugin::number(option.value);
  const bool whole = row.type != DUBSAR_TYPE_NUMBER;
  if (!value || *value < row.minimum || *value > row.maximum ||
      (whole && *value != static_cast<double>(static_cast<std::int64_t>(*value)))) {
    return false;
  }
  if (key == "buffers") {
    out.buffers = static_cast<std::uint32_t>(*value);
  } else if (key == "packet") {
    out.packet_bytes = static_cast<std::uint32_t>(*value);
  } else if (key == "resend") {
    out.resend = *value != 0;
  } else if (key == "raw_socket") {
    out.packet_socket = *value != 0;
  } else if (key == "rows") {
    out.rows = static_cast<std::int64_t>(*value);
  } else if (key == "row") {
    out.row_mm = *value;
  } else if (key == "count") {
    out.encoder_mm = *value;
  } else if (key == "flip") {
    out.flip_z = *value != 0;
  } else {
    out.wait_s = *value;
  }
  return true;
}

}  // namespace

std::span<const plugin::SettingRow> option_rows() {
  return kRows;
}

Result<CameraOptions> parse_options(std::span<const dubsar_option> options) {
  CameraOptions out;
  for (const dubsar_option& option : options) {
    // There is one: who loads drivers passes no others.
    const auto row = std::ranges::find(kRows, std::string_view(option.key), &plugin::SettingRow::key);
    if (row != kRows.end() && !take(*row, option, out)) {
      return plugin::not_understood(*row, option.value);
    }
  }
  return out;
}

}  // namespace dubsar::aravis
