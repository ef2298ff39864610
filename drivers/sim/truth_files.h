// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/pin_set.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "sim/sim_station.h"

namespace dubsar::sim_driver {

/// Writes what is true to files, for judging results afterwards; nothing of it goes through the driver
/// interface. In the folder: tablet.ply (the surface), truth_poses.json (model_from_scanner is
/// tablet_from_scanner), and with pins truth_pins.json (true centres) and pins.json (as an operator clicks
/// them, good to 1 mm). Scans are numbered from 0 in the order in which they were begun.
class TruthFiles {
 public:
  TruthFiles(std::filesystem::path folder, const sim::SimStation& station);

  /// Makes the folder and writes the surface.
  Status begin(const sim::SimStation& station) const;
  /// Adds the scan that is about to be made from where the station stands, and writes poses and pins anew.
  Status add_scan(int id, const std::string& name, const sim::SimStation& station);

 private:
  std::filesystem::path folder_;
  std::vector<ScanPose> poses_;
  PinSet true_pins_;
  PinSet clicked_pins_;
};

}  // namespace dubsar::sim_driver
