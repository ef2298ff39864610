// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/scan3d.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace dubsar::aravis {

namespace {

constexpr std::array<bool, 3> kAbc{true, true, true};
constexpr std::array<bool, 3> kAc{true, false, true};
constexpr std::array<bool, 3> kC{false, false, true};

constexpr RangeFormat kFormats[] = {
    {0x026000C0, "Coord3D_ABC32f", kAbc, 4, false}, {0x026000C1, "Coord3D_ABC32f_Planar", kAbc, 4, true},
    {0x024000C2, "Coord3D_AC32f", kAc, 4, false},   {0x024000C3, "Coord3D_AC32f_Planar", kAc, 4, true},
    {0x023000B9, "Coord3D_ABC16", kAbc, 2, false},  {0x023000BA, "Coord3D_ABC16_Planar", kAbc, 2, true},
    {0x022000BB, "Coord3D_AC16", kAc, 2, false},    {0x022000BC, "Coord3D_AC16_Planar", kAc, 2, true},
    {0x012000BF, "Coord3D_C32f", kC, 4, false},     {0x011000B8, "Coord3D_C16", kC, 2, false},
    {0x010800B1, "Coord3D_C8", kC, 1, false},
};

double number_at(const std::uint8_t* at, std::uint32_t bytes) {
  if (bytes == 1) {
    return *at;
  }
  if (bytes == 2) {  // little-endian, as GigE Vision and USB3 Vision send it
    return static_cast<double>(at[0] | at[1] << 8U);
  }
  float value = 0;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

std::span<const RangeFormat> range_formats() {
  return kFormats;
}

const RangeFormat* range_format(std::uint32_t code) {
  const auto* found = std::ranges::find(kFormats, code, &RangeFormat::code);
  return found == std::end(kFormats) ? nullptr : found;
}

const RangeFormat* range_format(const std::string& name) {
  const auto* found =
      std::ranges::find_if(kFormats, [&](const RangeFormat& one) { return name == one.name; });
  return found == std::end(kFormats) ? nullptr : found;
}

Status check(const Scan3d& meaning, const std::string& where) {
  constexpr std::uint32_t kMost = 1U << 16U;
  if (meaning.width == 0 || meaning.height == 0 || meaning.width > kMost || meaning.height > kMost) {
    return bad_input(where, "the camera announces frames of " + std::to_string(meaning.width) + " x " +
                                std::to_string(meaning.height) + " samples");
  }
  for (const AxisScale& axis : meaning.axes) {
    if (!std::isfinite(axis.scale) || axis.scale == 0 || !std::isfinite(axis.offset)) {
      return bad_input(where, "the camera's scale or offset of a coordinate is no number",
                       "load its calibration again with its maker's program");
    }
  }
  return {};
}

Status check_places(const Scan3d& meaning, double row_mm, const std::string& where) {
  if (!meaning.format.has[0] && !meaning.axes[0].told) {
    return fail(ErrorKind::kUsage, "the camera does not tell how far apart the samples of a profile lie",
                where, "ask for a Coord3D_AC format with format=");
  }
  if (!meaning.format.has[1] && !meaning.axes[1].told && row_mm == 0) {
    return fail(ErrorKind::kUsage, "nobody says how far apart the rows lie", where,
                "give row=, the motion from row to row in mm");
  }
  return {};
}

void read_row(const Scan3d& meaning, std::span<const std::uint8_t> frame, std::uint32_t row, double y_mm,
              ProfileRow& out) {
  const RangeFormat& format = meaning.format;
  const std::size_t width = meaning.width;
  out.x.resize(width);
  out.y.resize(width);
  out.z.resize(width);
  out.valid.resize(width);
  const std::size_t plane = width * meaning.height * format.bytes;
  for (std::size_t col = 0; col < width; ++col) {
    const std::size_t sample = row * width + col;
    std::array<double, 3> at{static_cast<double>(col), 0, 0};
    bool valid = true;
    std::size_t place = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!format.has[axis]) {
        continue;
      }
      const std::size_t offset = format.planar ? place * plane + sample * format.bytes
                                               : (sample * format.coordinates() + place) * format.bytes;
      ++place;
      at[axis] = number_at(frame.data() + offset, format.bytes);
      // The camera's value is told as a double; in a float format it is a float that is sent.
      const auto& invalid = meaning.axes[axis].invalid;
      valid = valid && std::isfinite(at[axis]) &&
              !(invalid &&
                (at[axis] == *invalid || at[axis] == static_cast<double>(static_cast<float>(*invalid))));
    }
    const auto mm = [&](std::size_t axis) {
      return (meaning.axes[axis].scale * at[axis] + meaning.axes[axis].offset) * meaning.unit_mm;
    };
    const auto x = static_cast<float>(mm(0));
    const auto y = static_cast<float>(format.has[1] ? mm(1) : y_mm);
    const auto z = static_cast<float>(meaning.flip_z ? -mm(2) : mm(2));
    valid = valid && std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    out.x[col] = valid ? x : kNone;
    out.y[col] = valid ? y : kNone;
    out.z[col] = valid ? z : kNone;
    out.valid[col] = valid ? 1 : 0;
  }
}

}  // namespace dubsar::aravis
