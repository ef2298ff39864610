// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/support/tablet_truth.h"
#include "planning/cleared_map.h"
#include "planning/red_map.h"
#include "registration/registrar.h"
#include "sim/sim_station.h"

namespace dubsar::bench {

struct LoopOptions {
  sim::TabletOptions tablet;
  sim::SimStationOptions station;
  std::size_t truth_points = 100000;
  bool registered = false;  ///< poses by registration; else the true ones
};

/// A simulated tablet on its station, the scans made so far and the red map's memory of them.
class ClosedLoop {
 public:
  /// Exits with a message when the tablet cannot be made.
  explicit ClosedLoop(const LoopOptions& options);

  [[nodiscard]] sim::SimStation& station() { return *station_; }
  [[nodiscard]] const sim::ScannerOptions& scanner() const { return options_.station.scanner; }
  [[nodiscard]] const TabletTruth& truth() const { return *truth_; }
  [[nodiscard]] const Rig& rig() const { return rig_; }

  /// Drives to the placement (none: stays) and scans. False when the scan could not be placed.
  bool scan(const std::optional<Placement>& placement);
  [[nodiscard]] int scans() const { return static_cast<int>(grids_.size()); }
  [[nodiscard]] std::vector<PlacedScan> placed() const { return cleared_.scans(); }
  [[nodiscard]] RedMapResult red_map();
  [[nodiscard]] StageState stage() const { return {scans() - 1, last_}; }
  [[nodiscard]] RigidTransform tablet_from_model() const;
  /// By placed scan: how far its pose carries the middle of its samples from where they were measured, mm;
  /// the first scan is the frame.
  [[nodiscard]] std::vector<double> pose_errors_mm() const;

  /// [points of truth] sampled well by some scan.
  [[nodiscard]] const std::vector<std::uint8_t>& sampled() const { return sampled_; }
  [[nodiscard]] double share_sampled() const;

 private:
  LoopOptions options_;
  std::unique_ptr<sim::SimStation> station_;
  std::unique_ptr<TabletTruth> truth_;
  Rig rig_;
  Registrar registrar_;
  ClearedMap cleared_;
  std::vector<std::shared_ptr<const RangeGrid>> grids_;
  std::vector<RigidTransform> true_poses_;
  std::vector<std::uint8_t> sampled_;
  Placement last_;
};

}  // namespace dubsar::bench
