// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "station/offered_devices.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// What a driver says of an option or a setting, as something to press or to type into: label with unit and
/// range, the value, the driver's help below. True when the value was changed; a line that is typed into
/// changes with every letter.
/// Whether a setting may be left to the driver: an empty value then says nothing, else "no".
enum class MaySay { kValue, kNothing };

bool setting_widget(UiContext& ui, const std::string& name, const SettingInfo& setting, std::string& value,
                    MaySay may = MaySay::kValue);

/// What was said in it, as the driver reads it: a number with a point.
[[nodiscard]] std::string driver_word(const SettingInfo& setting, const std::string& value);

}  // namespace dubsar::ui
