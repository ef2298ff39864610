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

  // A bad day. Scans and moves are numbered from 0 since the device was opened; -1: never.
  double move_time_s = 0;  ///< that each move takes; stop() ends it on the way
  int fail_move_at = -1;   ///< this move ends half way there
  int stop_at = -1;        ///< this scan ends after stop_rows rows
  int stop_rows = 30;
  int swap_at = -1;  ///< another tablet lies there from this scan on
  sim::Disturbance intrude = sim::Disturbance::kNone;
  int intrude_at = -1;    ///< the first scan that it is in the way of …
  int intrude_until = 0;  ///< … and the last …
  int intrude_every = 1;  ///< … of which each so manieth
};

/// The options that there are, for describe_options().
[[nodiscard]] std::span<const plugin::SettingRow> option_rows();
/// kUsage with the option and what it takes.
[[nodiscard]] Result<SimOptions> parse_options(std::span<const dubsar_option> options);

}  // namespace dubsar::sim_driver
