// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/device.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "core/motion_limits.h"
#include "core/utf8.h"
#include "drivers/abi.h"
#include "drivers/driver.h"
#include "drivers/driver_call.h"

namespace dubsar {

namespace {

/// "it has a, b": those of the settings that can be read, or changed.
std::string keys_of(std::vector<SettingInfo> settings, bool SettingInfo::*usable) {
  std::erase_if(settings, [&](const SettingInfo& one) { return !(one.*usable); });
  return "it has " + (settings.empty() ? "none" : abi::listed(settings, &SettingInfo::key));
}

/// Joins the sink of C callbacks to a ProfileSink. Nothing thrown by the sink may cross the driver.
struct SinkBridge {
  ProfileSink& sink;
  const std::string& where;
  std::optional<Error> refused;
  bool cancelled = false;
  bool begun = false;
  bool ended = false;

  bool pass(bool go_on) {
    cancelled = cancelled || !go_on;
    return go_on;
  }

  static std::int32_t on_begin(void* user, const dubsar_scan_info* info) noexcept {
    auto& self = *static_cast<SinkBridge*>(user);
    if (self.begun) {
      self.refused =
          Error{ErrorKind::kDevice, "the driver began one scan twice", self.where, "update the driver"};
      return 1;
    }
    Result<ScanInfo> taken = abi::scan_info_from(abi::taken(info), self.where);
    if (!taken) {
      self.refused = taken.error();
      return 1;
    }
    self.begun = true;
    return self.pass(self.sink.begin(*taken)) ? 0 : 1;
  }
  static std::int32_t on_profile(void* user, const dubsar_profile* profile) noexcept {
    auto& self = *static_cast<SinkBridge*>(user);
    if (self.cancelled || self.refused) {
      return 1;
    }
    if (!self.begun || self.ended) {
      self.refused = Error{ErrorKind::kDevice, "the driver sent a profile outside a scan", self.where,
                           "update the driver"};
      return 1;
    }
    const Result<Profile> taken = abi::profile_from(abi::taken(profile), self.where);
    if (!taken) {
      self.refused = taken.error();
      return 1;
    }
    return self.pass(self.sink.profile(*taken)) ? 0 : 1;
  }
  static void on_remark(void* user, const char* text) noexcept {
    auto& self = *static_cast<SinkBridge*>(user);
    const std::string said = one_line(abi::text(text));
    if (self.begun && !self.ended && !said.empty()) {
      self.sink.remark(said);
    }
  }
  static void on_end(void* user, const dubsar_scan_end* end) noexcept {
    auto& self = *static_cast<SinkBridge*>(user);
    if (self.begun && !self.ended) {
      const dubsar_scan_end taken = abi::taken(end);
      self.ended = true;
      self.sink.end({taken.profiles_sent, taken.profiles_dropped, taken.frames_repeated});
    }
  }
};

/// A text of a setting goes through a field of this size, with its NUL.
constexpr std::size_t kTextField = sizeof(dubsar_value::text);

Status check_value(const SettingInfo& setting, const SettingValue& value, const std::string& where) {
  const auto in_range = [&](double number) {
    return std::isfinite(number) &&
           (!setting.range || (number >= setting.range->first && number <= setting.range->second));
  };
  const auto* integer = std::get_if<std::int64_t>(&value);
  const auto* number = std::get_if<double>(&value);
  const auto* words = std::get_if<std::string>(&value);
  const bool short_enough = words != nullptr && words->size() < kTextField;
  bool fits = false;
  switch (setting.type) {
    case SettingType::kBool:
      fits = std::holds_alternative<bool>(value);
      break;
    case SettingType::kInteger:
      fits = integer != nullptr && in_range(static_cast<double>(*integer));
      break;
    case SettingType::kNumber:
      fits = number != nullptr && in_range(*number);
      break;
    case SettingType::kChoice:
      fits = short_enough && std::ranges::find(setting.choices, *words) != setting.choices.end();
      break;
    case SettingType::kText:
      fits = short_enough;
  }
  return fits ? Status{}
              : fail(ErrorKind::kUsage, "setting " + setting.key + " takes " + taken_by(setting), where);
}

}  // namespace

std::string taken_by(const SettingInfo& setting) {
  const auto within = [&](const char* what) {
    std::ostringstream out;
    out << what;
    if (setting.range) {
      out << std::setprecision(12) << " from " << setting.range->first << " to " << setting.range->second;
      out << (setting.unit.empty() ? "" : " ") << setting.unit;
    }
    return out.str();
  };
  switch (setting.type) {
    case SettingType::kBool:
      return "true or false";
    case SettingType::kInteger:
      return within("a whole number");
    case SettingType::kNumber:
      return within("a number");
    case SettingType::kChoice:
      return "one of " + abi::listed(setting.choices, [](const std::string& word) { return word; });
    case SettingType::kText:
      break;
  }
  return "a text of at most " + std::to_string(kTextField - 1) + " bytes";
}

Device::Device(const dubsar_driver* driver, dubsar_device* device, std::string uri)
    : driver_(driver),
      device_(device,
              [driver, uri](dubsar_device* open) {
                const DriverCall call(uri);
                driver->close(open);
              }),
      uri_(std::move(uri)) {}

Result<DeviceCapabilities> Device::capabilities() const {
  const DriverCall call(uri_);
  auto lent = abi::lent<dubsar_capabilities>();
  auto error = abi::lent<dubsar_error>();
  if (const std::int32_t code = driver_->capabilities(device_.get(), &lent, &error); code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  Result<DeviceCapabilities> out = abi::capabilities_from(lent, uri_);
  if (out) {
    out->can_place = driver_->place != nullptr;
  }
  return out;
}

Result<std::vector<SettingInfo>> Device::settings() const {
  std::vector<SettingInfo> out;
  if (driver_->describe_settings == nullptr) {
    return out;
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const auto collect = [](void* user, const dubsar_setting* setting) noexcept -> std::int32_t {
    static_cast<std::vector<SettingInfo>*>(user)->push_back(abi::setting_from(abi::taken(setting)));
    return 0;
  };
  if (const std::int32_t code = driver_->describe_settings(device_.get(), collect, &out, &error);
      code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  return out;
}

Result<SettingValue> Device::get(const std::string& key) const {
  const Result<std::vector<SettingInfo>> all = settings();
  if (!all) {
    return std::unexpected(all.error());
  }
  const auto setting = std::ranges::find(*all, key, &SettingInfo::key);
  if (setting == all->end() || !setting->readable) {
    return fail(ErrorKind::kUsage, "no setting " + key + " to read", uri_,
                keys_of(*all, &SettingInfo::readable));
  }
  const DriverCall call(uri_);
  auto value = abi::lent<dubsar_value>();
  auto error = abi::lent<dubsar_error>();
  if (const std::int32_t code = driver_->get_setting(device_.get(), key.c_str(), &value, &error);
      code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  switch (setting->type) {
    case SettingType::kBool:
      return value.integer != 0;
    case SettingType::kInteger:
      return value.integer;
    case SettingType::kNumber:
      return value.number;
    case SettingType::kText:
    case SettingType::kChoice:
      break;
  }
  return abi::text(value.text);
}

Status Device::set(const std::string& key, const SettingValue& value) {
  const Result<std::vector<SettingInfo>> all = settings();
  if (!all) {
    return std::unexpected(all.error());
  }
  const auto setting = std::ranges::find(*all, key, &SettingInfo::key);
  if (setting == all->end() || !setting->writable) {
    return fail(ErrorKind::kUsage, "no setting " + key + " to change", uri_,
                keys_of(*all, &SettingInfo::writable));
  }
  if (Status checked = check_value(*setting, value, uri_); !checked) {
    return checked;
  }
  auto passed = abi::lent<dubsar_value>();
  passed.type = static_cast<std::int32_t>(setting->type);
  if (const auto* flag = std::get_if<bool>(&value)) {
    passed.integer = *flag ? 1 : 0;
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    passed.integer = *integer;
  } else if (const auto* number = std::get_if<double>(&value)) {
    passed.number = *number;
  } else {
    std::ranges::copy(std::get<std::string>(value), passed.text);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = driver_->set_setting(device_.get(), key.c_str(), &passed, &error);
  return abi::status_from(code, error, uri_);
}

Status Device::place(const Placement& placement) {
  if (driver_->place == nullptr) {
    return fail(ErrorKind::kUsage, "this device cannot be placed", uri_, "turn the tablet by hand and scan");
  }
  const Result<DeviceCapabilities> can = capabilities();
  if (!can) {
    return std::unexpected(can.error());
  }
  if (can->rig) {
    if (Status allowed = check_limits(*can->rig, placement, uri_); !allowed) {
      return allowed;
    }
  }
  auto passed = abi::lent<dubsar_placement>();
  passed.turntable_rad = placement.turntable_rad;
  passed.tilt_rad = placement.tilt_rad;
  if (placement.hand_turn) {
    passed.has_hand_turn = 1;
    std::ranges::copy(placement.hand_turn->row_major(), passed.hand_turn);
  }
  if (placement.free_pose) {
    passed.has_free_pose = 1;
    std::ranges::copy(placement.free_pose->row_major(), passed.stage_from_scanner);
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = driver_->place(device_.get(), &passed, &error);
  return abi::status_from(code, error, uri_);
}

bool Device::can_stop() const {
  return abi::offered(driver_, &dubsar_driver::stop) != nullptr;
}

Status Device::stop() const {
  if (!can_stop()) {
    return {};
  }
  const DriverCall call(uri_);
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = driver_->stop(device_.get(), &error);
  return abi::status_from(code, error, uri_);
}

Result<ScanOutcome> Device::scan(ProfileSink& sink) {
  SinkBridge bridge{sink, uri_, {}};
  const dubsar_sink passed{
      sizeof(dubsar_sink),   0, &bridge, &SinkBridge::on_begin, &SinkBridge::on_profile, &SinkBridge::on_end,
      &SinkBridge::on_remark};
  auto error = abi::lent<dubsar_error>();
  const std::int32_t code = [&] {
    const DriverCall call(uri_);
    return driver_->scan(device_.get(), &passed, &error);
  }();
  if (bridge.begun && !bridge.ended) {
    sink.end({});
  }
  if (bridge.refused) {
    return std::unexpected(*bridge.refused);
  }
  if (bridge.cancelled) {
    return fail(ErrorKind::kCancelled, "scan cancelled", uri_);
  }
  if (code == DUBSAR_END && !bridge.begun) {
    return ScanOutcome::kExhausted;
  }
  if (code != DUBSAR_OK) {
    return std::unexpected(abi::error_from(code, error, uri_));
  }
  if (!bridge.begun) {
    return fail(ErrorKind::kDevice, "the driver reported a scan and sent none", uri_, "update the driver");
  }
  return ScanOutcome::kScanned;
}

}  // namespace dubsar
