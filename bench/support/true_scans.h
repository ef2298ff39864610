// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/pin_set.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/scan_pose.h"
#include "sim/scene.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// A scan of a simulated tablet with the pose that it was truly taken from.
struct TrueScan {
  std::shared_ptr<const RangeGrid> grid;
  RigidTransform tablet_from_scanner;
  std::vector<PinTip> clicked_tips;  ///< of the pins that stood in it, as an operator clicks them
  int tablet = 0;                    ///< scans of different tablets do not belong together
};

enum class Pins { kNone, kLabelled, kUnlabelled };

struct TrueScanOptions {
  double spacing_mm = 0.2;
  double noise_mm = 0.02;
  int views = 12;                      ///< that the plan is made for
  std::vector<std::size_t> only = {};  ///< of the plan; empty: all
  std::uint64_t seed = 1;
  Pins pins = Pins::kNone;
  int tablet_number = 0;
  double tip_diameter_mm = 1.0;
  int gripped_every = 0;  ///< fingers hold it by an edge in each so manieth scan; 0: in none
  /// Lines 0.15 mm deep, so far apart, are drawn over both of its faces from edge to edge, and it is made 1 %
  /// wider at one end; 0: none.
  double ruled_every_mm = 0;
};

/// Is shown each scan as it is made, with the scene that it was made of (tablet frame).
using ScanVisitor = std::function<void(const sim::Scene& scene, const TrueScan& scan)>;

inline constexpr std::array<std::string_view, 6> kTabletKinds{"text", "blank",     "worn",
                                                              "tiny", "symmetric", "ruled"};

/// A tablet of random size and wear, of one of kTabletKinds: "text" (written, damaged as most are), "blank"
/// (no text), "worn", "tiny" (20 mm), "symmetric" (blank, square and even), "ruled" (blank, even and longer
/// than wide: to be ruled).
[[nodiscard]] sim::TabletOptions random_tablet(std::uint64_t seed, std::string_view kind, double spacing_mm);

/// Scans it from free views with nothing told of the poses; exits the program when it cannot. Clicked tips
/// are off by up to 1 mm.
[[nodiscard]] std::vector<TrueScan> true_scans(const sim::TabletOptions& tablet,
                                               const TrueScanOptions& options,
                                               const ScanVisitor& visitor = {});

/// The pins of all scans as `--pins FILE` would give them.
[[nodiscard]] PinSet pin_set(const std::vector<TrueScan>& scans, Pins pins);

/// How far `a_from_b` is from the truth, and where the middle of the tablet goes.
struct PairError {
  double turn_deg = 0;
  double shift_mm = 0;
  bool foreign = false;  ///< the scans are of two tablets
  /// Beyond what a registration can be off by and still be called right.
  [[nodiscard]] bool wrong() const { return foreign || turn_deg > 1.0 || shift_mm > 0.5; }
};
[[nodiscard]] PairError pair_error(const TrueScan& a, const TrueScan& b, const RigidTransform& a_from_b);
/// Of two of the scans as they were laid; a pose's id is its scan's place.
[[nodiscard]] PairError pair_error(std::span<const TrueScan> scans, const ScanPose& a, const ScanPose& b);

}  // namespace dubsar::bench
