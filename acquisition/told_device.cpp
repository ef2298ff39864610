// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/told_device.h"

#include <filesystem>

#include "acquisition/device_uri.h"

namespace dubsar {

std::string told_device(std::string_view uri) {
  Result<DeviceUri> told = parse_device_uri(uri);
  if (!told) {
    return std::string(uri);
  }
  if (told->scheme == "replay" || told->scheme == "rig") {
    std::filesystem::path path = std::filesystem::path(told->locator).lexically_normal();
    if (!path.has_filename()) {
      path = path.parent_path();  // "scans/"
    }
    told->locator = path.filename().string();
  }
  return told->text() + (told->scheme == "sim" ? " (simulated: there is no such tablet)" : "");
}

}  // namespace dubsar
