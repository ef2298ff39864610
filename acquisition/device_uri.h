// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "drivers/loader.h"

namespace dubsar {

/// "scheme:locator?key=value&key=value", percent-decoded.
struct DeviceUri {
  std::string scheme;
  std::string locator;
  std::vector<std::pair<std::string, std::string>> options;  ///< in the order given, no key twice

  /// The text form again, with what would be misread percent-encoded.
  [[nodiscard]] std::string text() const;
};

/// Text without a scheme is a path and means replay:PATH, taken letter by letter. Errors (kUsage): empty
/// text, a broken percent escape, an option without '=', a key given twice.
[[nodiscard]] Result<DeviceUri> parse_device_uri(std::string_view text);

/// The same device whatever folder a program is started from: the path of a replay: or rig: is made absolute.
/// What cannot be read as a URI stays as it is.
[[nodiscard]] std::string absolute_device(const std::string& uri);

/// Opens what the URI names; an unknown scheme or option is answered with those that there are.
[[nodiscard]] Result<Device> open_device(const DeviceUri& uri, const DriverRegistry& registry);

}  // namespace dubsar
