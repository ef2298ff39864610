// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is settled with a camera before it streams: its format, its packets, and what its coordinates mean.
#include <algorithm>

#include "drivers/aravis/camera.h"
#include "drivers/aravis/glib.h"

namespace dubsar::aravis {

namespace {

struct MonoFormat {
  std::uint32_t code;
  const char* name;
  std::uint32_t bytes;
};
constexpr MonoFormat kMono[] = {{DUBSAR_PIXEL_MONO8, "Mono8", 1},
                                {DUBSAR_PIXEL_MONO16, "Mono16", 2},
                                {DUBSAR_PIXEL_MONO12, "Mono12", 2},
                                {DUBSAR_PIXEL_MONO10, "Mono10", 2},
                                {DUBSAR_PIXEL_MONO14, "Mono14", 2}};

}  // namespace

Status Camera::choose_format() {
  GErrorHolder error;
  const std::string now =
      text_read(error, [&](GError** e) { return arv_camera_get_pixel_format_as_string(camera_, e); });
  guint count = 0;
  const char** names = arv_camera_dup_available_pixel_formats_as_strings(camera_, &count, error.fill());
  const std::vector<std::string> offered(names, names == nullptr ? names : names + count);
  g_free(names);
  const auto has = [&](const std::string& name) { return std::ranges::find(offered, name) != offered.end(); };
  std::string chosen = options_.format;
  if (chosen.empty() && range_format(now) != nullptr) {
    chosen = now;
  }
  if (chosen.empty()) {
    // What scans in three dimensions says so; an ordinary camera offers no such formats.
    for (const RangeFormat& one : range_formats()) {
      chosen = chosen.empty() && has(one.name) && now.starts_with("Coord3D") ? one.name : chosen;
    }
    for (const MonoFormat& one : kMono) {
      chosen = chosen.empty() && (has(one.name) || now == one.name) ? one.name : chosen;
    }
  }
  range_ = range_format(chosen);
  const auto* mono = std::ranges::find_if(kMono, [&](const MonoFormat& one) { return chosen == one.name; });
  if ((range_ == nullptr && mono == std::end(kMono)) || !has(chosen)) {
    std::string all;
    for (const std::string& name : offered) {
      all += (all.empty() ? "" : ", ") + name;
    }
    return fail(ErrorKind::kUsage,
                chosen.empty() ? "the camera sends nothing that can be used"
                : !has(chosen) ? "the camera does not offer the format " + chosen
                               : "the format " + chosen + " cannot be used",
                id_,
                "it offers " + (all.empty() ? "none" : all) +
                    "; of these Mono8 to Mono16 and Coord3D_C, _AC and _ABC can be used");
  }
  arv_camera_set_pixel_format_from_string(camera_, chosen.c_str(), error.fill());
  if (error) {
    return std::unexpected(error.told("the camera refuses " + chosen, id_));
  }
  pixel_format_ = range_ != nullptr ? range_->code : mono->code;
  bytes_per_pixel_ = range_ != nullptr ? range_->sample_bytes() : mono->bytes;
  return {};
}

Status Camera::configure() {
  if (const Status chosen = choose_format(); !chosen) {
    return chosen;
  }
  GErrorHolder error;
  if (arv_camera_is_gv_device(camera_)) {
    if (options_.packet_bytes != 0) {
      arv_camera_gv_set_packet_size(camera_, static_cast<gint>(options_.packet_bytes), error.fill());
    } else {
      arv_camera_gv_auto_packet_size(camera_, error.fill());
    }
    if (error) {
      return std::unexpected(error.told("the camera refuses the size of packets", id_));
    }
    arv_camera_gv_set_stream_options(camera_, options_.packet_socket
                                                  ? ARV_GV_STREAM_OPTION_NONE
                                                  : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }
  arv_camera_set_acquisition_mode(camera_, ARV_ACQUISITION_MODE_CONTINUOUS, error.fill());
  // Chunks bring the count of an encoder with each frame, where there is one.
  has_encoder_chunk_ = arv_device_get_feature(device_, "ChunkEncoderValue") != nullptr;
  if (has_encoder_chunk_ && arv_device_get_feature(device_, "ChunkModeActive") != nullptr) {
    arv_device_set_boolean_feature_value(device_, "ChunkModeActive", TRUE, error.fill());
    has_encoder_chunk_ = !error;
  }
  const auto has = [&](const char* name) { return arv_device_get_feature(device_, name) != nullptr; };
  if (has_encoder_chunk_ && has("ChunkSelector") && has("ChunkEnable")) {
    GErrorHolder refused;  // by one that sends it always
    arv_device_set_string_feature_value(device_, "ChunkSelector", "EncoderValue", refused.fill());
    if (!refused) {
      arv_device_set_boolean_feature_value(device_, "ChunkEnable", TRUE, refused.fill());
    }
  }
  return {};
}

Result<Scan3d> Camera::scan3d() {
  Scan3d out;
  GErrorHolder error;
  out.format = *range_;
  out.flip_z = options_.flip_z;
  gint x = 0;
  gint y = 0;
  gint width = 0;
  gint height = 0;
  arv_camera_get_region(camera_, &x, &y, &width, &height, error.fill());
  if (error) {
    return std::unexpected(error.told("the camera does not tell its region", id_));
  }
  out.width = static_cast<std::uint32_t>(std::max(width, 0));
  out.height = static_cast<std::uint32_t>(std::max(height, 0));
  const auto has = [&](const char* name) { return arv_device_get_feature(device_, name) != nullptr; };
  const auto told = [&](const char* name) {
    return text_read(error,
                     [&](GError** e) { return arv_device_get_string_feature_value(device_, name, e); });
  };
  if (has("Scan3dOutputMode")) {
    const std::string mode = told("Scan3dOutputMode");
    if (error) {
      return std::unexpected(error.told("the camera does not tell its Scan3dOutputMode", id_));
    }
    const bool raw = mode.starts_with("Uncalibrated") || mode.starts_with("Disparity");
    // Without A in the data x is the column times a scale, which is true of rectified profiles alone.
    if (raw || (!range_->has[0] && !mode.starts_with("Rectified"))) {
      return fail(ErrorKind::kUsage, "the camera's output " + mode + " does not say where a sample is", id_,
                  "set Scan3dOutputMode to a rectified one, or ask for a Coord3D_AC format");
    }
  }
  if (has("Scan3dDistanceUnit")) {
    const std::string unit = told("Scan3dDistanceUnit");
    if (error) {
      return std::unexpected(error.told("the camera does not tell its Scan3dDistanceUnit", id_));
    }
    if (unit != "Millimeter" && unit != "Inch") {
      return fail(ErrorKind::kUsage, "the camera's distances are in " + unit, id_,
                  "set Scan3dDistanceUnit to Millimeter");
    }
    out.unit_mm = unit == "Inch" ? 25.4 : 1.0;
  }
  constexpr const char* kCoordinates[] = {"CoordinateA", "CoordinateB", "CoordinateC"};
  const bool selects = has("Scan3dCoordinateSelector");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    GErrorHolder refused;
    if (selects) {
      arv_device_set_string_feature_value(device_, "Scan3dCoordinateSelector", kCoordinates[axis],
                                          refused.fill());
    }
    if (refused || (!selects && axis != 2)) {
      continue;  // has no such axis
    }
    AxisScale& to = out.axes[axis];
    const auto read = [&](const char* name, double& value) {
      if (has(name)) {
        value = arv_device_get_float_feature_value(device_, name, refused.fill());
      }
      return !refused;
    };
    double invalid = 0;
    if (!read("Scan3dCoordinateScale", to.scale) || !read("Scan3dCoordinateOffset", to.offset)) {
      return std::unexpected(refused.told("the camera does not tell the scale of its coordinates", id_));
    }
    to.told = has("Scan3dCoordinateScale");
    if (has("Scan3dInvalidDataFlag") &&
        arv_device_get_boolean_feature_value(device_, "Scan3dInvalidDataFlag", refused.fill()) && !refused &&
        has("Scan3dInvalidDataValue")) {
      if (!read("Scan3dInvalidDataValue", invalid)) {
        return std::unexpected(refused.told("the camera does not tell what an invalid sample is", id_));
      }
      to.invalid = invalid;
    }
  }
  if (const Status sane = check(out, id_); !sane) {
    return std::unexpected(sane.error());
  }
  return out;
}

}  // namespace dubsar::aravis
