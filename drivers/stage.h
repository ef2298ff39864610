// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dubsar {

/// One axis of a stage: positions in mm or rad, speeds per second.
struct StageAxis {
  std::string name;
  bool rotary = false;
  bool can_home = false;
  bool endless = false;  ///< goes round and round; minimum and maximum are not its ends
  double minimum = 0;    ///< soft limits
  double maximum = 0;
  double speed_maximum = 0;
  double resolution = 0;
};

/// Where a stage is: positions that held at timestamp_ns, give or take uncertainty_ns.
struct StageReading {
  std::int64_t timestamp_ns = 0;  ///< this machine's CLOCK_MONOTONIC
  std::int64_t uncertainty_ns = 0;
  bool moving = false;
  bool alarm = false;      ///< the firmware refuses to move until it is homed
  bool homed = false;      ///< positions are those of the machine
  bool commanded = false;  ///< positions are what was asked for; the firmware does not report its own
  std::vector<double> position;
  std::vector<double> laser;  ///< power, 0 to 1
};

struct StageMove {
  std::uint32_t axis = 0;
  double position = 0;      ///< absolute
  double speed = 0;         ///< 0: as the setting `speed` says
  bool start_only = false;  ///< return once it moves
};

}  // namespace dubsar
