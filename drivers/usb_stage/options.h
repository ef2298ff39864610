// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "drivers/usb_stage/firmware.h"

namespace dubsar::usb_stage {

struct StageOptions {
  std::string firmware = "auto";
  std::vector<AxisWish> axes{AxisWish{}};
  TmclOptions tmcl;
};

[[nodiscard]] std::span<const plugin::SettingRow> option_rows();
/// kUsage with what an option takes.
[[nodiscard]] Result<StageOptions> parse_options(std::span<const dubsar_option> options);

}  // namespace dubsar::usb_stage
