// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "core/result.h"
#include "drivers/driver.h"
#include "drivers/plugin.h"
#include "sim/sim_station.h"
#include "sim/tablet.h"

namespace dubsar::sim_driver {

/// What the options of a sim: URI ask for.
struct SimOptions {
  sim::TabletOptions tablet;
  sim::SimStationOptions station;
  std::filesystem::path tablet_file;   ///< instead of a made-up tablet; empty without
  std::filesystem::path truth_folder;  ///< empty: no truth leaves the driver
};

/// The options that there are, for describe_options().
[[nodiscard]] std::span<const plugin::SettingRow> option_rows();
/// kUsage with the option and what it takes.
[[nodiscard]] Result<SimOptions> parse_options(std::span<const dubsar_option> options);

}  // namespace dubsar::sim_driver
