// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// A word of a file, a command line or a person as the type that the setting has. A bool is true or false, or
/// 1 or 0. Errors: kUsage.
[[nodiscard]] Result<SettingValue> setting_value(const SettingInfo& setting, const std::string& word,
                                                 const std::string& where);
/// And back: reading it again gives the same value.
[[nodiscard]] std::string setting_word(const SettingValue& value);

/// Changes settings of an open device, in this order. Errors: kUsage for one that there is not (with those
/// that there are), a word that does not fit, and those of the device; the ones before it stay changed.
Status put_settings(Device& device, const std::vector<std::pair<std::string, std::string>>& words,
                    const std::string& where);

}  // namespace dubsar
