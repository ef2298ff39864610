// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>

#include "core/result.h"
#include "drivers/device.h"
#include "drivers/driver.h"

/// The host's side of the plugin interface: what comes from a driver is copied and checked here. Not for
/// drivers.
namespace dubsar::abi {

/// A copy of a struct that a driver made: what lies beyond its struct_size reads as zero.
template <class T>
[[nodiscard]] T taken(const T* from) {
  T out{};
  if (from != nullptr) {
    std::memcpy(static_cast<void*>(&out), from, std::min<std::size_t>(from->struct_size, sizeof out));
  }
  return out;
}

template <class T>
[[nodiscard]] T lent() {
  T out{};
  out.struct_size = sizeof out;
  return out;
}

/// A function that drivers need not have: null when the driver was made before there was one, or has none.
template <class Function>
[[nodiscard]] Function* offered(const dubsar_driver* driver, Function* dubsar_driver::*member) {
  const auto offset = static_cast<std::size_t>(reinterpret_cast<const char*>(&(driver->*member)) -
                                               reinterpret_cast<const char*>(driver));
  return offset + sizeof(Function*) <= driver->struct_size ? driver->*member : nullptr;
}

/// Text of a field of fixed size, whether the driver ended it with NUL or not.
template <std::size_t N>
[[nodiscard]] std::string text(const char (&field)[N]) {
  return {field, ::strnlen(field, N)};
}
[[nodiscard]] inline std::string text(const char* c_string) {
  return c_string == nullptr ? std::string() : std::string(c_string);
}

/// The names of things, parted by commas, for a line that says what there is.
template <class Things, class Name>
[[nodiscard]] std::string listed(const Things& things, Name name) {
  std::string out;
  for (const auto& thing : things) {
    if (!out.empty()) {
      out += ", ";
    }
    out += std::invoke(name, thing);
  }
  return out;
}

/// The error that a driver's code and error struct mean; `where` where the driver named none.
[[nodiscard]] Error error_from(std::int32_t code, const dubsar_error& error, const std::string& where);
[[nodiscard]] inline Status status_from(std::int32_t code, const dubsar_error& error,
                                        const std::string& where) {
  return code == DUBSAR_OK ? Status{} : std::unexpected(error_from(code, error, where));
}
/// "the driver `what`": of one that answers what it must not.
[[nodiscard]] Error faulty(const std::string& where, const std::string& what);

[[nodiscard]] SettingInfo setting_from(const dubsar_setting& setting);
[[nodiscard]] ScannerView view_from(const dubsar_view& view);
[[nodiscard]] Result<DeviceCapabilities> capabilities_from(const dubsar_capabilities& capabilities,
                                                           const std::string& where);
[[nodiscard]] Result<ScanInfo> scan_info_from(const dubsar_scan_info& info, const std::string& where);
[[nodiscard]] Result<Profile> profile_from(const dubsar_profile& profile, const std::string& where);
/// Without its lease.
[[nodiscard]] Result<Frame> frame_from(const dubsar_frame& frame, const std::string& where);
[[nodiscard]] Result<StageAxis> axis_from(const dubsar_axis& axis, const std::string& where);
[[nodiscard]] Result<StageReading> motion_from(const dubsar_motion& motion, const std::string& where);

}  // namespace dubsar::abi
