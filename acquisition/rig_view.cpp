// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_view.h"

#include <algorithm>
#include <utility>

#include "drivers/plugin.h"

namespace dubsar {

namespace {

std::int32_t no_camera(dubsar_error* error) {
  return plugin::report(error, DUBSAR_USAGE, "this rig has no camera to look through");
}

std::int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Device* const camera = device->source->camera();
    if (camera == nullptr) {
      return DUBSAR_OK;  // nothing to set
    }
    const Result<std::vector<SettingInfo>> settings = camera->settings();
    if (!settings) {
      return plugin::report(error, settings.error());
    }
    for (const SettingInfo& setting : *settings) {
      std::string choices;
      for (const std::string& choice : setting.choices) {
        choices += (choices.empty() ? "" : "|") + choice;
      }
      dubsar_setting out{};
      out.struct_size = sizeof out;
      out.type = static_cast<std::int32_t>(setting.type);
      out.flags = (setting.readable ? DUBSAR_SETTING_READABLE : 0U) |
                  (setting.writable ? DUBSAR_SETTING_WRITABLE : 0U);
      out.key = setting.key.c_str();
      out.help = setting.help.c_str();
      out.unit = setting.unit.empty() ? nullptr : setting.unit.c_str();
      out.choices = choices.empty() ? nullptr : choices.c_str();
      out.minimum = setting.range ? setting.range->first : 1;
      out.maximum = setting.range ? setting.range->second : 0;
      out.step = setting.step;
      if (callback(user, &out) != 0) {
        return DUBSAR_CANCELLED;
      }
    }
    return DUBSAR_OK;
  });
}

std::int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Device* const camera = device->source->camera();
    if (camera == nullptr) {
      return no_camera(error);
    }
    const Result<SettingValue> is = camera->get(key);
    if (!is) {
      return plugin::report(error, is.error());
    }
    dubsar_value out{};
    if (const auto* flag = std::get_if<bool>(&*is)) {
      out.type = DUBSAR_TYPE_BOOL;
      out.integer = *flag ? 1 : 0;
    } else if (const auto* integer = std::get_if<std::int64_t>(&*is)) {
      out.type = DUBSAR_TYPE_INTEGER;
      out.integer = *integer;
    } else if (const auto* number = std::get_if<double>(&*is)) {
      out.type = DUBSAR_TYPE_NUMBER;
      out.number = *number;
    } else {
      out.type = DUBSAR_TYPE_TEXT;
      plugin::copy_text(out.text, std::get<std::string>(*is));
    }
    plugin::lend(value, out);
    return DUBSAR_OK;
  });
}

std::int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Device* const camera = device->source->camera();
    if (camera == nullptr) {
      return no_camera(error);
    }
    SettingValue to;
    switch (value->type) {
      case DUBSAR_TYPE_BOOL:
        to = value->integer != 0;
        break;
      case DUBSAR_TYPE_INTEGER:
        to = value->integer;
        break;
      case DUBSAR_TYPE_NUMBER:
        to = value->number;
        break;
      default:
        to = std::string(value->text);
        break;
    }
    return plugin::answer(camera->set(key, to), error);
  });
}

std::int32_t start_frames(dubsar_device* device, std::uint32_t /*pool*/, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->source->start_view(), error); });
}

std::int32_t next_frame(dubsar_device* device, std::uint32_t timeout_ms, dubsar_frame* frame,
                        dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Device* const camera = device->source->camera();
    if (camera == nullptr) {
      return no_camera(error);
    }
    Result<std::optional<Frame>> next = camera->next_frame(std::chrono::milliseconds(timeout_ms));
    if (!next) {
      return plugin::report(error, next.error());
    }
    if (!*next) {
      return DUBSAR_TIMEOUT;
    }
    constexpr std::uint32_t kFormats[] = {DUBSAR_PIXEL_MONO8, DUBSAR_PIXEL_MONO10, DUBSAR_PIXEL_MONO12,
                                          DUBSAR_PIXEL_MONO14, DUBSAR_PIXEL_MONO16};
    const Frame& is = **next;
    dubsar_frame out{};
    out.flags = (is.incomplete ? DUBSAR_FRAME_INCOMPLETE : 0U) | (is.encoder ? DUBSAR_FRAME_ENCODER : 0U) |
                (is.exposed ? DUBSAR_FRAME_EXPOSED : 0U) | (is.late ? DUBSAR_FRAME_LATE : 0U);
    out.id = static_cast<std::uint64_t>(is.id);
    out.timestamp_ns = is.timestamp_ns;
    out.device_timestamp_ns = is.device_timestamp_ns;
    out.encoder = is.encoder.value_or(0);
    out.pixels = is.pixels.data();
    out.size_bytes = is.pixels.size();
    out.width = is.width;
    out.height = is.height;
    out.stride_bytes = is.stride_bytes;
    out.pixel_format = kFormats[static_cast<int>(is.format)];
    out.offset_x = is.offset_x;
    out.offset_y = is.offset_y;
    const std::scoped_lock lock(device->mutex);
    out.lease = ++device->leases;
    device->lent.emplace(out.lease, std::move(**next));
    plugin::lend(frame, out);
    return DUBSAR_OK;
  });
}

void release_frame(dubsar_device* device, std::uint64_t lease) {
  const std::scoped_lock lock(device->mutex);
  device->lent.erase(lease);
}

std::int32_t stop_frames(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->source->stop_view(), error); });
}

/// Of the view alone: a scan sees to its laser itself, and how bright it is the rig's file says.
std::int32_t set_laser(dubsar_device* device, std::uint32_t /*laser*/, double power, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->source->light_view(power > 0), error); });
}

std::int32_t frame_counters(dubsar_device* device, dubsar_frame_counters* counters, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    Device* const camera = device->source->camera();
    if (camera == nullptr) {
      return no_camera(error);
    }
    const Result<FrameCounters> count = camera->frame_counters();
    if (!count) {
      return plugin::report(error, count.error());
    }
    dubsar_frame_counters out{};
    out.pool = count->pool;
    out.delivered = count->delivered;
    out.lost = count->lost;
    out.late = count->late;
    out.incomplete = count->incomplete;
    out.resent = count->resent;
    out.reconnections = count->reconnections;
    out.starved = count->starved;
    plugin::lend(counters, out);
    return DUBSAR_OK;
  });
}

}  // namespace

void offer_view(dubsar_driver& driver) {
  driver.describe_settings = describe_settings;
  driver.get_setting = get_setting;
  driver.set_setting = set_setting;
  driver.start_frames = start_frames;
  driver.next_frame = next_frame;
  driver.release_frame = release_frame;
  driver.stop_frames = stop_frames;
  driver.frame_counters = frame_counters;
  driver.set_laser = set_laser;
}

}  // namespace dubsar
