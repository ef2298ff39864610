// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// v4l2: any camera that Linux drives as /dev/videoN. Frames alone; a rig makes scans of them.
#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "drivers/v4l2/camera.h"

using namespace dubsar;

struct dubsar_device {
  std::unique_ptr<v4l2::Camera> camera;
};

namespace {

constexpr double kSlowestHz = 0.01;
constexpr double kFastestHz = 100000;

constexpr std::array<plugin::SettingRow, 4> kOptions{{
    {DUBSAR_TYPE_TEXT, "format",
     "what the camera sends, by its four letters, e.g. GREY; default: the best for stripes"},
    {DUBSAR_TYPE_TEXT, "size", "width x height, e.g. 1280x1024; default: the largest of that format", "px"},
    {DUBSAR_TYPE_NUMBER, "rate", "frames per second, at least; default: the fastest", "Hz", nullptr,
     kSlowestHz, kFastestHz},
    {DUBSAR_TYPE_INTEGER, "buffers", "frames in the pool; default: half a second of them", nullptr, nullptr,
     2, 32},
}};

std::optional<std::uint32_t> whole_number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

Result<v4l2::CameraOptions> parse_options(std::span<const dubsar_option> options) {
  v4l2::CameraOptions out;
  for (const dubsar_option& option : options) {
    const std::string_view key = option.key;
    const std::string_view value = option.value;
    bool good = true;
    if (key == "format") {
      out.wish.fourcc = v4l2::fourcc_from(std::string(value));
      good = out.wish.fourcc.has_value();
    } else if (key == "size") {
      const std::size_t cross = value.find('x');
      const auto width = whole_number(value.substr(0, cross));
      const auto height = cross == value.npos ? std::nullopt : whole_number(value.substr(cross + 1));
      good = width && height && *width > 0 && *height > 0;
      if (good) {
        out.wish.size = {*width, *height};
      }
    } else if (key == "rate") {
      out.wish.rate_hz = plugin::number(value);
      good = out.wish.rate_hz && *out.wish.rate_hz >= kOptions[2].minimum &&
             *out.wish.rate_hz <= kOptions[2].maximum;
    } else if (key == "buffers") {
      const auto buffers = whole_number(value);
      good = buffers && *buffers >= 2 && *buffers <= 32;
      out.buffers = buffers.value_or(0);
    }
    if (!good) {
      return plugin::not_understood(*std::ranges::find(kOptions, key, &plugin::SettingRow::key), value);
    }
  }
  return out;
}

std::int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* /*error*/) {
  return plugin::describe(kOptions, callback, user);
}

std::int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    for (const auto& [path, name] : v4l2::find_cameras("/dev")) {
      const std::string uri = "v4l2:" + path;
      const dubsar_device_info info{sizeof info, uri.c_str(), name.c_str()};
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
      return plugin::report(error, DUBSAR_USAGE, "no camera is named", "v4l2:", "write v4l2:/dev/video0");
    }
    const Result<v4l2::CameraOptions> parsed = parse_options({options, count});
    if (!parsed) {
      return plugin::report(error, parsed.error());
    }
    Result<std::unique_ptr<v4l2::Camera>> camera = v4l2::Camera::open(locator, *parsed);
    if (!camera) {
      return plugin::report(error, camera.error());
    }
    *device = new dubsar_device{std::move(*camera)};
    return DUBSAR_OK;
  });
}

void close(dubsar_device* device) {
  device->camera->stop();
  delete device;
}

std::int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    dubsar_capabilities filled{};
    filled.struct_size = sizeof filled;
    filled.flags = DUBSAR_YIELDS_FRAMES | DUBSAR_YIELDS_NO_SCANS;
    filled.scan_count = -1;
    filled.calibration_age_days = -1;
    plugin::copy_text(filled.name, device->camera->model());
    plugin::copy_text(filled.model, device->camera->model());
    plugin::copy_text(filled.serial, device->camera->serial());
    plugin::lend(out, filled);
    return DUBSAR_OK;
  });
}

/// A number of the region that a camera may be asked for, on its way to and from a setting.
struct RegionKey {
  const char* key;
  const char* help;
  std::uint32_t v4l2::Region::*value;
  std::uint32_t v4l2::Region::*within;  ///< of the whole picture: what it ends at
};
/// A region has to have its size before it can go from the corner.
constexpr std::array<RegionKey, 4> kRegionKeys{{
    {"width_px", "of a frame", &v4l2::Region::width, &v4l2::Region::width},
    {"height_px", "of a frame", &v4l2::Region::height, &v4l2::Region::height},
    {"offset_x_px", "of a frame in the whole picture", &v4l2::Region::x, &v4l2::Region::width},
    {"offset_y_px", "of a frame in the whole picture", &v4l2::Region::y, &v4l2::Region::height},
}};

const RegionKey* find_region_key(std::string_view key) {
  const auto* found = std::ranges::find(kRegionKeys, key, &RegionKey::key);
  return found == kRegionKeys.end() ? nullptr : found;
}

/// Of what the camera sends.
std::vector<plugin::SettingRow> mode_rows(const v4l2::Camera& camera) {
  std::vector<plugin::SettingRow> out{{DUBSAR_TYPE_TEXT, "pixel_format", "what the camera sends", nullptr,
                                       nullptr, 1, 0, DUBSAR_SETTING_READABLE}};
  const bool cuts = camera.whole().has_value();
  for (const RegionKey& one : kRegionKeys) {
    const bool is_size = one.value == one.within;
    const double most = cuts ? (*camera.whole()).*one.within : 0;
    out.push_back({DUBSAR_TYPE_INTEGER, one.key, one.help, "px", nullptr, is_size ? 1.0 : 0.0,
                   cuts ? most - (is_size ? 0 : 1) : -1.0,
                   DUBSAR_SETTING_READABLE | (cuts ? DUBSAR_SETTING_WRITABLE : 0U)});
  }
  out.push_back(
      {DUBSAR_TYPE_NUMBER, "frame_rate_hz", "frames per second", "Hz", nullptr, kSlowestHz, kFastestHz});
  return out;
}

std::int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (const std::int32_t code = plugin::describe(mode_rows(*device->camera), callback, user);
        code != DUBSAR_OK) {
      return code;
    }
    for (const v4l2::Control& control : device->camera->controls()) {
      const std::string words = control.choice_words();
      const bool ranged = control.type == DUBSAR_TYPE_INTEGER || control.type == DUBSAR_TYPE_NUMBER;
      const dubsar_setting setting{sizeof(dubsar_setting),
                                   control.type,
                                   control.flags,
                                   control.key.c_str(),
                                   control.help.c_str(),
                                   control.unit.empty() ? nullptr : control.unit.c_str(),
                                   control.choices.empty() ? nullptr : words.c_str(),
                                   ranged ? control.minimum : 1,
                                   ranged ? control.maximum : 0,
                                   control.step};
      if (callback(user, &setting) != 0) {
        return DUBSAR_CANCELLED;
      }
    }
    return DUBSAR_OK;
  });
}

const v4l2::Control* find_control(const v4l2::Camera& camera, const char* key) {
  const auto control = std::ranges::find(camera.controls(), std::string(key), &v4l2::Control::key);
  return control == camera.controls().end() ? nullptr : &*control;
}

std::int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const std::string_view name = key;
    dubsar_value filled{};
    filled.struct_size = sizeof filled;
    const v4l2::Mode& mode = device->camera->mode();
    if (name == "pixel_format") {
      plugin::copy_text(filled.text, v4l2::name_of(mode.fourcc));
    } else if (const RegionKey* const of_region = find_region_key(name)) {
      filled.integer = device->camera->region().*of_region->value;
    } else if (name == "frame_rate_hz") {
      filled.number = mode.rate_hz;
    } else {
      const v4l2::Control* control = find_control(*device->camera, key);
      if (control == nullptr) {
        return plugin::report(error, DUBSAR_USAGE, "no such setting", key);
      }
      const Result<dubsar_value> read = device->camera->get(*control);
      if (!read) {
        return plugin::report(error, read.error());
      }
      filled = *read;
    }
    plugin::lend(value, filled);
    return DUBSAR_OK;
  });
}

std::int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    v4l2::Camera& camera = *device->camera;
    Status set;
    if (const RegionKey* const of_region = find_region_key(key)) {
      v4l2::Region wanted = camera.region();
      wanted.*of_region->value = static_cast<std::uint32_t>(value->integer);
      set = camera.set_region(wanted);
    } else if (std::string_view(key) == "frame_rate_hz") {
      set = camera.set_rate(value->number);
    } else if (const v4l2::Control* const control = find_control(camera, key)) {
      set = camera.set(*control, *value);
    } else {
      return plugin::report(error, DUBSAR_USAGE, "no such setting to change", key);
    }
    return plugin::answer(set, error);
  });
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* /*sink*/, dubsar_error* error) {
  return plugin::report(error, DUBSAR_USAGE, "a camera alone makes no scans", device->camera->path(),
                        "name it in a rig file and scan with rig:FILE.toml");
}

std::int32_t start_frames(dubsar_device* device, std::uint32_t pool, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->camera->start(pool), error); });
}

std::int32_t next_frame(dubsar_device* device, std::uint32_t timeout_ms, dubsar_frame* frame,
                        dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const auto until = v4l2::Stream::Clock::now() + std::chrono::milliseconds(timeout_ms);
    const Result<std::optional<dubsar_frame>> next = device->camera->next(until);
    if (!next) {
      return plugin::report(error, next.error());
    }
    if (!*next) {
      return DUBSAR_TIMEOUT;
    }
    plugin::lend(frame, **next);
    return DUBSAR_OK;
  });
}

void release_frame(dubsar_device* device, std::uint64_t lease) {
  device->camera->give_back(lease);
}

std::int32_t stop_frames(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    device->camera->stop();
    return DUBSAR_OK;
  });
}

std::int32_t frame_counters(dubsar_device* device, dubsar_frame_counters* counters, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    plugin::lend(counters, device->camera->counters());
    return DUBSAR_OK;
  });
}

constexpr dubsar_driver kDriver = [] {
  dubsar_driver out = plugin::empty_driver();
  out.scheme = "v4l2";
  out.description = "cameras that Linux drives (UVC and the like)";
  out.version = "1";
  out.locator_help = "/dev/videoN";
  out.describe_options = describe_options;
  out.discover = discover;
  out.open = open;
  out.close = close;
  out.capabilities = capabilities;
  out.describe_settings = describe_settings;
  out.get_setting = get_setting;
  out.set_setting = set_setting;
  out.scan = scan;
  out.start_frames = start_frames;
  out.next_frame = next_frame;
  out.release_frame = release_frame;
  out.stop_frames = stop_frames;
  out.frame_counters = frame_counters;
  return out;
}();

}  // namespace

const dubsar_driver* dubsar_driver_entry() {
  return &kDriver;
}
