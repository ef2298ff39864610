// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/offered_devices.h"

#include "acquisition/device_uri.h"
#include "drivers/loader.h"

namespace dubsar {

std::vector<OfferedDriver> offered_drivers() {
  const DriverRegistry registry;
  std::vector<OfferedDriver> out;
  // No plugin: put together of several devices (acquisition/device_uri.h).
  out.push_back(
      {"rig", "camera, stage and calibration together, as a file describes them", "FILE.toml", {}, {}, {}});
  for (const Driver& driver : registry.drivers()) {
    OfferedDriver offered{driver.scheme(), driver.description(), driver.locator_help(), {}, {}, {}};
    if (auto options = driver.options()) {
      offered.options = std::move(*options);
    } else {
      offered.trouble = options.error().line();
    }
    if (const auto found = driver.discover()) {
      for (const FoundDevice& device : *found) {
        offered.found.emplace_back(device.uri, device.description);
      }
    } else {
      offered.trouble = found.error().line();
    }
    out.push_back(std::move(offered));
  }
  return out;
}

std::optional<UriParts> uri_parts(const std::string& uri) {
  const Result<DeviceUri> parts = parse_device_uri(uri);
  return parts ? std::optional(UriParts{parts->scheme, parts->locator, parts->options}) : std::nullopt;
}

std::string compose_uri(const std::string& scheme, const std::string& locator,
                        const std::vector<std::pair<std::string, std::string>>& options) {
  DeviceUri uri{scheme, locator, {}};
  for (const auto& option : options) {
    if (!option.second.empty()) {
      uri.options.push_back(option);
    }
  }
  return uri.text();
}

}  // namespace dubsar
