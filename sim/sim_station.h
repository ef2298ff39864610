// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/keep_out.h"
#include "core/range_grid.h"
#include "core/rig.h"
#include "sim/disturbance.h"
#include "sim/pins.h"
#include "sim/scanner.h"

namespace dubsar::sim {

struct SimStationOptions {
  ScannerOptions scanner;
  std::optional<PinOptions> pins;
  double tilt_max_deg = 70;
  double hand_max_deg = 10;  ///< a hand turn comes out off by up to this
  double hand_max_mm = 5;
  double motor_sigma_deg = 0.005;  ///< of turntable and tilt, each move
  double motor_sigma_mm = 0.01;
  bool robot = false;  ///< an arm carries the scanner, and the stage stands still
  std::uint64_t seed = 1;
};

/// The whole simulated station: a tablet on a matt black support on a turntable and a scanner that tilts, or
/// a stage that stands still and a scanner on an arm, and an operator who turns the tablet over when asked.
/// Knows the truth and what the motors say; only the latter may reach the engine. The model frame is the
/// tablet's frame as the first placement's nominal pose has it.
class SimStation {
 public:
  SimStation(SimTablet tablet, const SimStationOptions& options);

  [[nodiscard]] Rig rig() const;
  /// Whether the placement and the way there are within limits and clear of tablet, pins and support, as the
  /// station knows them: by where the tablet was asked to lie. kUsage.
  [[nodiscard]] Status check(const Placement& placement) const;
  /// Drives turntable and tilt, or the arm; with a hand turn the operator first turns the tablet and puts the
  /// pins back. share < 1: stopped on the way. Errors: those of check(); nothing has moved then.
  [[nodiscard]] Status move(const Placement& placement, double share = 1.0);
  /// How far hand turns come out wrong from now on.
  void set_hand_error(double most_deg, double most_mm) {
    options_.hand_max_deg = most_deg;
    options_.hand_max_mm = most_mm;
  }

  /// What motors and asked turns say. Never the truth.
  [[nodiscard]] NominalPose nominal() const;
  /// What nominal().tablet_from_scanner would be after that move.
  [[nodiscard]] RigidTransform nominal_after(const Placement& placement) const;

  [[nodiscard]] RigidTransform true_tablet_from_scanner() const;
  [[nodiscard]] RigidTransform true_stage_from_tablet() const { return true_stage_from_tablet_; }
  /// Pins that stand in the present scan, true, in the scanner frame.
  [[nodiscard]] std::vector<PinTip> true_tips() const;
  /// The same as the operator clicks them, good to 1 mm.
  [[nodiscard]] std::vector<PinTip> clicked_tips() const;
  [[nodiscard]] const SimTablet& tablet() const { return *tablet_; }
  [[nodiscard]] const MeshQuery& query() const { return *query_; }

  /// Another tablet lies there from now on, put down by hand as the old one lay; motors and asked turns know
  /// nothing of it.
  void swap(SimTablet tablet);
  /// What is in the way of the scans from now on, from where everything stands. kNone: nothing any more. A
  /// grip is elsewhere at each turn.
  void disturb(Disturbance what, int turn = 0);

  /// Header of the scan that would be made now: an empty grid with geometry, nominal pose and pins filled in.
  [[nodiscard]] RangeGrid empty_grid() const;
  /// Scans from where everything stands, profile by profile; each call is a scan of its own.
  [[nodiscard]] Status scan(const RowSink& sink, JobContext& job);
  [[nodiscard]] Result<RangeGrid> scan_grid(JobContext& job);

 private:
  struct Drive {
    double turntable_rad = 0;
    double tilt_rad = 0;
    Eigen::Vector3d focus_mm{0, 0, 0};
    std::optional<RigidTransform> arm;  ///< of a robot, stage_from_scanner
    [[nodiscard]] RigidTransform stage_from_scanner() const;
  };
  /// The height that an operator with a ruler expects.
  [[nodiscard]] double resting_height_mm(const Eigen::Matrix3d& stage_from_tablet) const;
  [[nodiscard]] RigidTransform asked_pose(const RigidTransform& from, const RigidTransform& turn) const;
  /// Height of the centre at which the true surface just touches the support.
  [[nodiscard]] double touching_height_mm(const Eigen::Matrix3d& stage_from_tablet) const;
  /// How the tablet really comes to lie: within a hand's error both of the pose that was asked for and of
  /// where a perfect turn of what lay there would have taken it.
  [[nodiscard]] RigidTransform by_hand(const RigidTransform& asked, const RigidTransform& after_turn) const;
  void drive_to(const Placement& placement);
  /// Height of what the scanner looks at, stage frame, with a tablet that lies so: its middle, unless it was
  /// asked to be raised or lowered.
  [[nodiscard]] double focus_height_mm(const RigidTransform& stage_from_tablet,
                                       const Placement& placement) const;
  /// The placement that the motors believe to be at.
  [[nodiscard]] Placement present() const;
  /// The tablet, and the pins around it, as it was asked to lie.
  [[nodiscard]] StageScene nominal_scene(const RigidTransform& stage_from_tablet,
                                         const Placement& placement) const;
  void set_scene();

  SimStationOptions options_;
  TriangulationScanner scanner_;
  std::unique_ptr<SimTablet> tablet_;
  std::unique_ptr<MeshQuery> query_;
  std::optional<PinStand> pins_;
  std::unique_ptr<SimTablet> disturbed_;  ///< what stands there instead, while something is in the way
  std::unique_ptr<MeshQuery> disturbed_query_;
  Eigen::Vector3d half_size_mm_{0, 0, 0};
  RigidTransform nominal_stage_from_tablet_;
  RigidTransform true_stage_from_tablet_;
  double focus_above_middle_mm_ = 0;  ///< as the last hand turn asked
  Drive nominal_drive_;
  Drive true_drive_;
  Scene scene_;
  int placement_ = 0;
  int swaps_ = 0;
  int moves_ = 0;
  int scans_made_ = 0;
};

}  // namespace dubsar::sim
