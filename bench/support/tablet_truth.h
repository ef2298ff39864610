// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/mesh_query.h"
#include "core/placed_scan.h"
#include "planning/red_targets.h"
#include "sim/scanner.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// The excused part of a red map, judged.
struct ExcuseScore {
  double unreachable_mm2 = 0;        ///< excused as such, by the program's own estimate of area
  double truly_unreachable_mm2 = 0;  ///< of that
  double unneeded_mm2 = 0;
  std::vector<double> interpolation_error_mm;  ///< of each unneeded target, distance to the truth
};

/// The true surface of a simulated tablet as evenly spread points, and which of them have been sampled well:
/// a non-flagged sample (its neighbours within 3µ) of some scan lies within 1.5 µ and three times the noise.
class TabletTruth {
 public:
  TabletTruth(const sim::SimTablet& tablet, const MeshQuery& query, const sim::ScannerOptions& scanner,
              double tilt_max_deg, std::size_t points);

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] double area_of_point_mm2() const { return area_mm2_ / static_cast<double>(points_.size()); }
  [[nodiscard]] double area_mm2() const { return area_mm2_; }
  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }
  [[nodiscard]] const std::vector<Eigen::Vector3f>& normals() const { return normals_; }

  /// Which points the scan (its pose tablet_from_scanner) samples well.
  [[nodiscard]] std::vector<std::uint8_t> sampled_by(const PlacedScan& scan) const;

  struct Share {
    double of_reachable = 1;
    /// The same without the walls of slits narrower than 3µ, which the seed's rule lets pass as closed.
    double outside_slits = 1;
  };
  /// Share of the reachable surface that is sampled; what is not sampled is tried from 300 directions and 12
  /// turns of the scanner each.
  [[nodiscard]] Share share_of_reachable(const std::vector<std::uint8_t>& sampled, JobContext& job) const;
  /// Of the points that are not sampled, those that no pose reaches. Found by brute force: points that rays
  /// of laser and camera reach from some of 300 directions, with 12 turns of the scanner each, are looked at
  /// by the simulated scanner itself from all of these, group by group; what none of its scans samples with
  /// neighbours within 3µ is out of reach. Lone points count as reachable.
  [[nodiscard]] std::vector<std::uint8_t> unreachable(const std::vector<std::uint8_t>& sampled,
                                                      JobContext& job) const;

  /// Excuses against the truth. An unreachable target counts by the share of the unsampled points around it
  /// that no pose reaches; where all is sampled around it, it was reached, and the excuse is wrong.
  [[nodiscard]] ExcuseScore judge(const std::vector<RedTarget>& targets,
                                  const RigidTransform& tablet_from_model, double cell_mm,
                                  const std::vector<std::uint8_t>& sampled, JobContext& job) const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> sampled_points(const PlacedScan& scan,
                                                         const std::vector<std::uint32_t>& which) const;
  void scan_from_everywhere(const std::vector<std::uint32_t>& group,
                            std::vector<std::uint8_t>& unreachable) const;

  const sim::SimTablet* tablet_;
  const MeshQuery* query_;
  sim::ScannerOptions scanner_;
  double tilt_max_rad_;
  double area_mm2_;
  std::vector<Eigen::Vector3f> points_, normals_;
};

}  // namespace dubsar::bench
