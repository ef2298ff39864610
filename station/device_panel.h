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

/// Replaces or adds one.
void put_word(SettingWords& words, const std::string& key, const std::string& word);

/// What was changed of a device, by its URI, in the session: put again whenever the session goes on with it.
/// Empty where nothing was. Errors: kBadInput, and those of the store.
[[nodiscard]] Result<SettingWords> kept_settings(const SessionStore& store, const std::string& uri);
/// And that this device is the one that the session goes on with.
Status keep_settings(SessionStore& store, const std::string& uri, const SettingWords& words);

/// URI of the device that the session was opened with last; empty where none is kept. Errors: as above.
[[nodiscard]] Result<std::string> own_device(const SessionStore& store);

}  // namespace dubsar
