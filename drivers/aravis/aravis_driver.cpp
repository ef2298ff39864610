// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// aravis: GigE Vision and USB3 Vision cameras. Those that send frames are cameras; those that send Coord3D
// profiles are range sources.
#include <algorithm>

#include "drivers/aravis/camera.h"
#include "drivers/aravis/options.h"
#include "drivers/aravis/profiles.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"

using namespace dubsar;
using aravis::Camera;

struct dubsar_device {
  std::unique_ptr<Camera> camera;
  std::atomic<bool> stopped = false;  ///< set by stop(), from any thread
};

namespace {

std::int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* /*error*/) {
  return plugin::describe(aravis::option_rows(), callback, user);
}

std::int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    for (const aravis::FoundCamera& found : aravis::find_cameras()) {
      const std::string uri = "aravis:" + found.id;
      const dubsar_device_info info{sizeof info, uri.c_str(), found.description.c_str()};
      if (callback(user, &info) != 0) {
        return DUBSAR_CANCELLED;
      }
    }
    return DUBSAR_OK;
  });
}

std::int32_t open(const char* locator, const dubsar_option* options, std::uint32_t count,
                  dubsar_device** device, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (*locator == '\0') {
      return plugin::report(error, DUBSAR_USAGE, "no camera is named",
                            "aravis:", "write aravis:ID; dubsar drivers lists them; an address will do");
    }
    const Result<aravis::CameraOptions> parsed = aravis::parse_options({options, count});
    if (!parsed) {
      return plugin::report(error, parsed.error());
    }
    Result<std::unique_ptr<Camera>> camera = Camera::open(locator, *parsed);
    if (!camera) {
      return plugin::report(error, camera.error());
    }
    auto made = std::make_unique<dubsar_device>();
    made->camera = std::move(*camera);
    *device = made.release();
    return DUBSAR_OK;
  });
}

void close(dubsar_device* device) {
  delete device;
}

std::int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    dubsar_capabilities filled{};
    filled.struct_size = sizeof filled;
    // How the stage moves under a range camera only its rig knows.
    filled.flags = device->camera->range() != nullptr ? 0U : DUBSAR_YIELDS_FRAMES | DUBSAR_YIELDS_NO_SCANS;
    filled.scan_count = -1;
    filled.calibration_age_days = -1;
    plugin::copy_text(filled.name, device->camera->model());
    plugin::copy_text(filled.model, device->camera->model());
    plugin::copy_text(filled.serial, device->camera->serial());
    plugin::lend(out, filled);
    return DUBSAR_OK;
  });
}

std::int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    for (const Camera::Feature& feature : device->camera->features()) {
      const dubsar_setting setting{
          sizeof(dubsar_setting),
          feature.type,
          DUBSAR_SETTING_READABLE | (feature.writable ? DUBSAR_SETTING_WRITABLE : 0U),
          feature.key.c_str(),
          feature.help.c_str(),
          feature.unit.empty() ? nullptr : feature.unit.c_str(),
          feature.choices.empty() ? nullptr : feature.choices.c_str(),
          feature.minimum,
          feature.maximum,
          0};
      if (callback(user, &setting) != 0) {
        return DUBSAR_CANCELLED;
      }
    }
    return DUBSAR_OK;
  });
}

template <class Body>
std::int32_t with_feature(dubsar_device* device, const char* key, dubsar_error* error, const Body& body) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const std::vector<Camera::Feature> all = device->camera->features();
    const auto feature = std::ranges::find(all, std::string(key), &Camera::Feature::key);
    if (feature == all.end()) {
      return plugin::report(error, DUBSAR_USAGE, "no such setting", key);
    }
    return body(*feature);
  });
}

std::int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  return with_feature(device, key, error, [&](const Camera::Feature& feature) -> std::int32_t {
    const Result<dubsar_value> read = device->camera->get(feature);
    if (!read) {
      return plugin::report(error, read.error());
    }
    plugin::lend(value, *read);
    return DUBSAR_OK;
  });
}

std::int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) {
  return with_feature(device, key, error, [&](const Camera::Feature& feature) {
    return plugin::answer(device->camera->set(feature, *value), error);
  });
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (device->camera->range() == nullptr) {
      return plugin::report(error, DUBSAR_USAGE, "a camera alone makes no scans", device->camera->id(),
                            "name it in a rig file and scan with rig:FILE.toml");
    }
    device->stopped = false;
    return plugin::answer(aravis::run_scan(*device->camera, *sink, device->stopped), error);
  });
}

/// A scan that runs is told, and the camera by the scan: what that answered is known when the scan is over.
std::int32_t stop(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] {
    device->stopped = true;
    return plugin::answer(device->camera->ended(), error);
  });
}

std::int32_t start_frames(dubsar_device* device, std::uint32_t pool, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (device->camera->range() != nullptr) {
      return plugin::report(error, DUBSAR_USAGE, "this camera sends profiles, no frames",
                            device->camera->id(), "scan with it, or open it with ?format=Mono8");
    }
    return plugin::answer(device->camera->start(pool), error);
  });
}

std::int32_t next_frame(dubsar_device* device, std::uint32_t timeout_ms, dubsar_frame* frame,
                        dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const auto until = aravis::Clock::now() + std::chrono::milliseconds(timeout_ms);
    const Result<std::optional<aravis::Taken>> next = device->camera->next(until);
    if (!next) {
      return plugin::report(error, next.error());
    }
    if (!*next) {
      return DUBSAR_TIMEOUT;
    }
    const aravis::Taken& taken = **next;
    dubsar_frame out{};
    out.struct_size = sizeof out;
    out.flags = (taken.encoder ? DUBSAR_FRAME_ENCODER : 0U) | (taken.late ? DUBSAR_FRAME_LATE : 0U);
    out.lease = taken.lease;
    out.id = taken.id;
    out.timestamp_ns = taken.timestamp_ns;
    out.device_timestamp_ns = taken.device_timestamp_ns;
    out.encoder = taken.encoder.value_or(0);
    out.pixels = taken.pixels;
    out.size_bytes = taken.size;
    out.width = taken.width;
    out.height = taken.height;
    out.stride_bytes = static_cast<std::uint32_t>(taken.size / taken.height);
    out.pixel_format = device->camera->pixel_format();
    out.offset_x = taken.offset_x;
    out.offset_y = taken.offset_y;
    plugin::lend(frame, out);
    return DUBSAR_OK;
  });
}

void release_frame(dubsar_device* device, std::uint64_t lease) {
  device->camera->give_back(lease);
}

std::int32_t stop_frames(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->camera->stop(), error); });
}

std::int32_t frame_counters(dubsar_device* device, dubsar_frame_counters* counters, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    plugin::lend(counters, device->camera->counters());
    return DUBSAR_OK;
  });
}

std::int32_t trigger_frame(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->camera->trigger(), error); });
}

constexpr dubsar_driver kDriver = [] {
  dubsar_driver out = plugin::empty_driver();
  out.scheme = "aravis";
  out.description = "GigE Vision and USB3 Vision cameras and range cameras";
  out.version = "1";
  out.locator_help = "ID";
  out.describe_options = describe_options;
  out.discover = discover;
  out.open = open;
  out.close = close;
  out.capabilities = capabilities;
  out.describe_settings = describe_settings;
  out.get_setting = get_setting;
  out.set_setting = set_setting;
  out.scan = scan;
  out.stop = stop;
  out.start_frames = start_frames;
  out.next_frame = next_frame;
  out.release_frame = release_frame;
  out.stop_frames = stop_frames;
  out.frame_counters = frame_counters;
  out.trigger_frame = trigger_frame;
  return out;
}();

}  // namespace

const dubsar_driver* dubsar_driver_entry() {
  return &kDriver;
}
