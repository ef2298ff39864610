// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/pinned_scans.h"

#include <cmath>
#include <optional>

#include "bench/support/true_scans.h"
#include "core/parallel.h"

namespace dubsar::bench {

namespace {

/// Farther off its ray's surface than noise puts it, even where the surface is grazed.
constexpr double kStrayMm = 0.25;

/// A sample lies on the laser's ray that made it, wherever noise or a mixture put it: the ray is cast again.
std::vector<SampleTruth> truth_of(const RangeGrid& grid, const sim::Scene& scene,
                                  const RigidTransform& tablet_from_scanner) {
  std::vector<SampleTruth> truth(grid.size(), SampleTruth::kNothing);
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t row) {
        const Eigen::Vector3d laser =
            *grid.view.laser_mm + static_cast<double>(row) * grid.view.motion_per_row_mm;
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = grid.index(static_cast<int>(row), col);
          if (grid.valid[i] == 0) {
            continue;
          }
          const Eigen::Vector3d way = grid.point(i).cast<double>() - laser;
          const auto hit = sim::first_hit(scene, tablet_from_scanner * laser,
                                          tablet_from_scanner.rotation * way.normalized(), 2.0 * way.norm());
          // A ray along an edge may just miss what it met with other rounding: the nearest thing is clay.
          const bool pin = hit && hit->pin;
          const bool stray = !hit || std::abs(hit->distance_mm - way.norm()) > kStrayMm;
          truth[i] = pin ? (stray ? SampleTruth::kStrayPin : SampleTruth::kPin)
                         : (stray ? SampleTruth::kStrayClay : SampleTruth::kClay);
        }
      },
      4);
  return truth;
}

}  // namespace

std::vector<PinnedScan> pinned_scans(const sim::TabletOptions& tablet, const PinnedScanOptions& options) {
  TrueScanOptions scan_options;
  scan_options.spacing_mm = options.spacing_mm;
  scan_options.noise_mm = options.noise_mm;
  scan_options.views = options.views;
  scan_options.seed = options.seed;
  scan_options.pins = Pins::kUnlabelled;
  scan_options.tip_diameter_mm = options.tip_diameter_mm;
  std::vector<PinnedScan> scans;
  (void)true_scans(tablet, scan_options, [&](const sim::Scene& scene, const TrueScan& made) {
    const RigidTransform& pose = made.tablet_from_scanner;
    PinnedScan scan{*made.grid, pose, scene.pins, truth_of(*made.grid, scene, pose)};
    const RigidTransform scanner_from_tablet = pose.inverse();
    for (sim::Pin& pin : scan.pins) {
      pin.tip_mm = scanner_from_tablet * pin.tip_mm;
      pin.arm = scanner_from_tablet.rotation * pin.arm;
    }
    scans.push_back(std::move(scan));
  });
  return scans;
}

int ball_samples(const PinnedScan& scan, const sim::Pin& pin) {
  int count = 0;
  for (std::size_t i = 0; i < scan.grid.size(); ++i) {
    if (scan.truth[i] != SampleTruth::kPin) {
      continue;
    }
    const Eigen::Vector3d d = scan.grid.point(i).cast<double>() - pin.tip_mm;
    count += d.norm() < 1.25 * pin.tip_radius_mm && d.dot(pin.arm) <= 0 ? 1 : 0;
  }
  return count;
}

}  // namespace dubsar::bench
