// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Frames and stages as drivers tell of them, checked.
#include <cmath>

#include "drivers/abi.h"

namespace dubsar::abi {

namespace {

std::optional<PixelFormat> format_from(std::uint32_t code) {
  switch (code) {
    case DUBSAR_PIXEL_MONO8:
      return PixelFormat::kMono8;
    case DUBSAR_PIXEL_MONO10:
      return PixelFormat::kMono10;
    case DUBSAR_PIXEL_MONO12:
      return PixelFormat::kMono12;
    case DUBSAR_PIXEL_MONO14:
      return PixelFormat::kMono14;
    case DUBSAR_PIXEL_MONO16:
      return PixelFormat::kMono16;
    default:
      return std::nullopt;
  }
}

}  // namespace

Result<Frame> frame_from(const dubsar_frame& from, const std::string& where) {
  const std::optional<PixelFormat> format = format_from(from.pixel_format);
  if (!format) {
    return std::unexpected(faulty(where, "sent pixels of a format that has no place here"));
  }
  constexpr std::uint32_t kMostPixels = 1U << 16U;  // a side
  const std::uint64_t row = std::uint64_t{from.width} * bytes_per_pixel(*format);
  if (from.pixels == nullptr || from.width == 0 || from.height == 0 || from.width > kMostPixels ||
      from.height > kMostPixels || from.stride_bytes < row ||
      from.size_bytes < std::uint64_t{from.stride_bytes} * (from.height - 1) + row) {
    return std::unexpected(faulty(where, "sent a frame that is smaller than it says"));
  }
  Frame out;
  out.id = static_cast<std::int64_t>(from.id);
  out.timestamp_ns = from.timestamp_ns;
  out.exposed = (from.flags & DUBSAR_FRAME_EXPOSED) != 0;
  out.device_timestamp_ns = from.device_timestamp_ns;
  if ((from.flags & DUBSAR_FRAME_ENCODER) != 0) {
    out.encoder = from.encoder;
  }
  out.incomplete = (from.flags & DUBSAR_FRAME_INCOMPLETE) != 0;
  out.late = (from.flags & DUBSAR_FRAME_LATE) != 0;
  out.format = *format;
  out.width = from.width;
  out.height = from.height;
  out.stride_bytes = from.stride_bytes;
  out.offset_x = from.offset_x;
  out.offset_y = from.offset_y;
  out.pixels = {from.pixels, from.size_bytes};
  return out;
}

Result<StageAxis> axis_from(const dubsar_axis& from, const std::string& where) {
  StageAxis out;
  out.name = text(from.name);
  out.rotary = from.kind == DUBSAR_AXIS_ROTARY;
  out.can_home = (from.flags & DUBSAR_AXIS_CAN_HOME) != 0;
  out.endless = (from.flags & DUBSAR_AXIS_ENDLESS) != 0;
  out.minimum = from.minimum;
  out.maximum = from.maximum;
  out.speed_maximum = from.speed_maximum;
  out.resolution = from.resolution;
  if (!std::isfinite(out.minimum) || !std::isfinite(out.maximum) || out.minimum > out.maximum ||
      !std::isfinite(out.speed_maximum) || out.speed_maximum <= 0) {
    return std::unexpected(faulty(where, "told an axis whose limits are none"));
  }
  return out;
}

Result<StageReading> motion_from(const dubsar_motion& from, const std::string& where) {
  if (from.axis_count > DUBSAR_AXES_MAX || from.laser_count > DUBSAR_LASERS_MAX) {
    return std::unexpected(faulty(where, "told of more axes or lasers than there can be"));
  }
  StageReading out;
  out.timestamp_ns = from.timestamp_ns;
  out.uncertainty_ns = from.uncertainty_ns;
  out.moving = (from.flags & DUBSAR_MOTION_MOVING) != 0;
  out.alarm = (from.flags & DUBSAR_MOTION_ALARM) != 0;
  out.homed = (from.flags & DUBSAR_MOTION_HOMED) != 0;
  out.commanded = (from.flags & DUBSAR_MOTION_COMMANDED) != 0;
  out.position.assign(from.position, from.position + from.axis_count);
  out.laser.assign(from.laser, from.laser + from.laser_count);
  for (const double position : out.position) {
    if (!std::isfinite(position)) {
      return std::unexpected(faulty(where, "told a position that is none"));
    }
  }
  return out;
}

}  // namespace dubsar::abi
