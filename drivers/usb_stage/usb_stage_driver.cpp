// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// usb_stage: motion and laser over a serial line of USB, for controllers with GRBL, Horus or TMCL.
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "drivers/usb_stage/controller.h"
#include "drivers/usb_stage/options.h"
#include "drivers/usb_stage/usb_link.h"

using namespace dubsar;
using usb_stage::Controller;

struct dubsar_device {
  std::string serial, product;  // of the link that was opened last
  std::unique_ptr<Controller> controller;
};

namespace {

std::int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* /*error*/) {
  return plugin::describe(usb_stage::option_rows(), callback, user);
}

std::int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    for (const usb_stage::FoundController& found : usb_stage::find_controllers()) {
      const std::string uri = "usb_stage:" + found.name.text();
      const dubsar_device_info info{sizeof info, uri.c_str(), found.product.c_str()};
      if (callback(user, &info) != 0) {
        return DUBSAR_CANCELLED;
      }
    }
    return DUBSAR_OK;
  });
}

/// The firmware that was asked for, or the one whose banner a reset brings.
Result<std::unique_ptr<usb_stage::Firmware>> make_firmware(const usb_stage::StageOptions& options,
                                                           usb_stage::Link& link, const std::string& where) {
  if (options.firmware == "tmcl") {
    return usb_stage::make_tmcl(link, options.axes, options.tmcl, where);
  }
  if (options.firmware == "horus") {
    return usb_stage::make_horus(link, options.axes, where);
  }
  if (options.firmware == "grbl") {
    return usb_stage::make_grbl(link, options.axes, where);
  }
  return usb_stage::make_by_banner(link, options.axes, where);
}

std::int32_t open(const char* locator, const dubsar_option* options, std::uint32_t count,
                  dubsar_device** device, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const std::optional<usb_stage::UsbName> name = usb_stage::UsbName::parse(locator);
    if (!name) {
      return plugin::report(error, DUBSAR_USAGE, "no controller is named",
                            std::string("usb_stage:") + locator,
                            "write usb_stage:VID:PID, e.g. usb_stage:2341:0043; dubsar drivers lists them");
    }
    const Result<usb_stage::StageOptions> parsed = usb_stage::parse_options({options, count});
    if (!parsed) {
      return plugin::report(error, parsed.error());
    }
    auto made = std::make_unique<dubsar_device>();
    usb_stage::Ways ways;
    ways.link = [name, opened = made.get()]() -> Result<std::unique_ptr<usb_stage::Link>> {
      Result<std::unique_ptr<usb_stage::UsbLink>> link = usb_stage::UsbLink::open(*name);
      if (!link) {
        return std::unexpected(link.error());
      }
      opened->serial = (*link)->serial();
      opened->product = (*link)->product();
      return std::move(*link);
    };
    ways.firmware = [parsed, name](usb_stage::Link& link) {
      return make_firmware(*parsed, link, name->text());
    };
    ways.guard = [name, opened = made.get()](const std::string& panic) {
      // This very one: another of its kind may be there while this one is not.
      return usb_stage::Guard::start({name->vendor, name->product, opened->serial}, panic);
    };
    Result<std::unique_ptr<Controller>> controller = Controller::open(std::move(ways), name->text());
    if (!controller) {
      return plugin::report(error, controller.error());
    }
    made->controller = std::move(*controller);
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
    filled.flags = DUBSAR_IS_STAGE | DUBSAR_YIELDS_NO_SCANS;
    filled.scan_count = -1;
    filled.calibration_age_days = -1;
    plugin::copy_text(filled.name, device->product);
    plugin::copy_text(filled.model, device->product + ", " + device->controller->version());
    plugin::copy_text(filled.serial, device->serial);
    plugin::lend(out, filled);
    return DUBSAR_OK;
  });
}

/// Of the first axis, in which its speed is shown.
double unit_of_speed(const Controller& controller) {
  return usb_stage::unit_of(controller.axes().front().rotary);
}

std::int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                               dubsar_error* /*error*/) {
  const usb_stage::Axis& axis = device->controller->axes().front();
  const double most = axis.speed_maximum / unit_of_speed(*device->controller);
  const dubsar_setting speed{sizeof speed,
                             DUBSAR_TYPE_NUMBER,
                             DUBSAR_SETTING_READABLE | DUBSAR_SETTING_WRITABLE,
                             "speed",
                             "of moves that name none; other axes go at the same share of their greatest",
                             axis.rotary ? "deg/s" : "mm/s",
                             nullptr,
                             most * 1e-6,
                             most,
                             0};
  if (callback(user, &speed) != 0) {
    return DUBSAR_CANCELLED;
  }
  for (int laser = 0; laser < device->controller->lasers(); ++laser) {
    const std::string key = "laser_" + std::to_string(laser);
    const dubsar_setting power{sizeof power,
                               DUBSAR_TYPE_NUMBER,
                               DUBSAR_SETTING_READABLE | DUBSAR_SETTING_WRITABLE,
                               key.c_str(),
                               "its power; 0 is off",
                               nullptr,
                               nullptr,
                               0,
                               1,
                               0};
    if (callback(user, &power) != 0) {
      return DUBSAR_CANCELLED;
    }
  }
  return DUBSAR_OK;
}

/// The number of a laser setting; -1 of another.
int laser_of(std::string_view key) {
  return key.size() == 7 && key.starts_with("laser_") && key[6] >= '0' && key[6] <= '9' ? key[6] - '0' : -1;
}

std::int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    dubsar_value filled{};
    filled.struct_size = sizeof filled;
    filled.type = DUBSAR_TYPE_NUMBER;
    const int laser = laser_of(key);
    if (laser >= 0) {
      const Result<Controller::Motion> now = device->controller->read();
      if (!now) {
        return plugin::report(error, now.error());
      }
      if (static_cast<std::size_t>(laser) >= now->power.size()) {
        return plugin::report(error, DUBSAR_USAGE, "no such laser", key);
      }
      filled.number = now->power[static_cast<std::size_t>(laser)];
    } else if (std::string_view(key) == "speed") {
      filled.number = device->controller->speed() / unit_of_speed(*device->controller);
    } else {
      return plugin::report(error, DUBSAR_USAGE, "no such setting", key);
    }
    plugin::lend(value, filled);
    return DUBSAR_OK;
  });
}

std::int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    if (const int laser = laser_of(key); laser >= 0) {
      return plugin::answer(device->controller->set_laser(static_cast<std::size_t>(laser), value->number),
                            error);
    }
    if (std::string_view(key) == "speed") {
      device->controller->set_speed(value->number * unit_of_speed(*device->controller));
      return DUBSAR_OK;
    }
    return plugin::report(error, DUBSAR_USAGE, "no such setting", key);
  });
}

std::int32_t scan(dubsar_device* device, const dubsar_sink* /*sink*/, dubsar_error* error) {
  return plugin::report(error, DUBSAR_USAGE, "a stage alone makes no scans", device->controller->where(),
                        "name it in a rig file and scan with rig:FILE.toml");
}

std::int32_t stop(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->controller->stop(), error); });
}

std::int32_t describe_axes(dubsar_device* device, dubsar_axis_callback callback, void* user,
                           dubsar_error* /*error*/) {
  for (const usb_stage::Axis& axis : device->controller->axes()) {
    dubsar_axis out{};
    out.struct_size = sizeof out;
    out.flags = (axis.can_home ? DUBSAR_AXIS_CAN_HOME : 0U) | (axis.endless ? DUBSAR_AXIS_ENDLESS : 0U);
    out.kind = axis.rotary ? DUBSAR_AXIS_ROTARY : DUBSAR_AXIS_LINEAR;
    out.name = axis.name.c_str();
    out.minimum = axis.minimum;
    out.maximum = axis.maximum;
    out.speed_maximum = axis.speed_maximum;
    out.resolution = axis.resolution;
    if (callback(user, &out) != 0) {
      return DUBSAR_CANCELLED;
    }
  }
  return DUBSAR_OK;
}

std::int32_t home(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->controller->home(), error); });
}

std::int32_t move(dubsar_device* device, const dubsar_move* asked, dubsar_error* error) {
  return plugin::fenced(error, [&] {
    return plugin::answer(device->controller->move(asked->axis, asked->position, asked->speed,
                                                   (asked->flags & DUBSAR_MOVE_START_ONLY) != 0),
                          error);
  });
}

std::int32_t read_motion(dubsar_device* device, dubsar_motion* motion, dubsar_error* error) {
  return plugin::fenced(error, [&]() -> std::int32_t {
    const Result<Controller::Motion> now = device->controller->read();
    if (!now) {
      return plugin::report(error, now.error());
    }
    dubsar_motion out{};
    out.struct_size = sizeof out;
    const usb_stage::Position& at = now->position;
    out.flags = (at.moving ? DUBSAR_MOTION_MOVING : 0U) | (at.alarm ? DUBSAR_MOTION_ALARM : 0U) |
                (now->homed ? DUBSAR_MOTION_HOMED : 0U) | (at.commanded ? DUBSAR_MOTION_COMMANDED : 0U);
    out.timestamp_ns = at.timestamp_ns;
    out.uncertainty_ns = at.uncertainty_ns;
    out.axis_count = static_cast<std::uint32_t>(std::min<std::size_t>(at.axes.size(), DUBSAR_AXES_MAX));
    out.laser_count = static_cast<std::uint32_t>(std::min<std::size_t>(now->power.size(), DUBSAR_LASERS_MAX));
    std::copy_n(at.axes.begin(), out.axis_count, out.position);
    std::copy_n(now->power.begin(), out.laser_count, out.laser);
    plugin::lend(motion, out);
    return DUBSAR_OK;
  });
}

std::int32_t set_laser(dubsar_device* device, std::uint32_t laser, double power, dubsar_error* error) {
  return plugin::fenced(error,
                        [&] { return plugin::answer(device->controller->set_laser(laser, power), error); });
}

std::int32_t emergency_stop(dubsar_device* device, dubsar_error* error) {
  return plugin::fenced(error, [&] { return plugin::answer(device->controller->emergency_stop(), error); });
}

constexpr dubsar_driver kDriver = [] {
  dubsar_driver out = plugin::empty_driver();
  out.scheme = "usb_stage";
  out.description = "motion and laser: GRBL, Horus and TMCL controllers over USB";
  out.version = "1";
  out.locator_help = "VID:PID[:SERIAL]";
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
  out.describe_axes = describe_axes;
  out.home = home;
  out.move = move;
  out.read_motion = read_motion;
  out.set_laser = set_laser;
  out.emergency_stop = emergency_stop;
  return out;
}();

}  // namespace

const dubsar_driver* dubsar_driver_entry() {
  return &kDriver;
}
