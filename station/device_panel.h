// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "acquisition/session_store.h"
#include "drivers/device.h"

namespace dubsar {

/// Settings by key, as words, in the order in which they were changed.
using SettingWords = std::vector<std::pair<std::string, std::string>>;

/// What a device that is open lets one see and change.
struct DevicePanel {
  struct Setting {
    SettingInfo info;
    std::string word;  ///< as it stands; empty where it cannot be read
  };
  std::string uri;
  std::vector<Setting> settings;
  bool has_camera = false;
};

[[nodiscard]] Result<DevicePanel> panel_of(Device& device);

/// Of a setting that nobody takes now.
inline constexpr const char* kNotSet =
    "this is not set: nothing has the scanner that could take it; set it again once it scans or shows its "
    "camera";

/// Replaces or adds one.
void put_word(SettingWords& words, const std::string& key, const std::string& word);

/// Puts words that were kept one by one, in their order: some may be of a driver before this one, or of a
/// camera that was changed. What could not be put, in one line; empty where all were.
[[nodiscard]] std::string put_kept(Device& device, const SettingWords& words, const std::string& uri);

/// What was changed of a device, by its URI, in the session: put again whenever the session goes on with it.
/// Empty where nothing was. Errors: kBadInput, and those of the store.
[[nodiscard]] Result<SettingWords> kept_settings(const SessionStore& store, const std::string& uri);
/// And that this device is the one that the session goes on with.
Status keep_settings(SessionStore& store, const std::string& uri, const SettingWords& words);
/// Of a device that may not have scanned the tablet: a session that has scans goes on with the device that it
/// went on with.
Status note_settings(SessionStore& store, const std::string& uri, const SettingWords& words);

/// URI of the device that the session was opened with last; empty where none is kept. Errors: as above.
[[nodiscard]] Result<std::string> own_device(const SessionStore& store);

}  // namespace dubsar
