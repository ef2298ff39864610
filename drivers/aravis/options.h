// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/result.h"
#include "drivers/aravis/camera.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"

namespace dubsar::aravis {

[[nodiscard]] std::span<const plugin::SettingRow> option_rows();
/// kUsage with what an option takes.
[[nodiscard]] Result<CameraOptions> parse_options(std::span<const dubsar_option> options);

}  // namespace dubsar::aravis
