// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar::bench {

/// A real scan with its published pose.
struct PublishedScan {
  std::string name;
  std::shared_ptr<const RangeGrid> grid;
  RigidTransform model_from_scanner;
  Eigen::Vector3d centroid_mm{0, 0, 0};  ///< of its samples, scanner frame
};

/// Two scans to be registered: `moved` onto `on`.
struct PairCase {
  std::size_t on = 0, moved = 0;  ///< places in the list of scans
  double overlap = 0;             ///< of the published poses, over the smaller scan
  RigidTransform on_from_moved;   ///< of the published poses
};

/// A start that is off by so much: a turn about a random axis through the centroid of the moved scan, and a
/// shift in a random direction.
struct StartClass {
  double turn_deg = 0;
  double shift_mm = 0;
};
inline constexpr StartClass kStartClasses[] = {{5, 5}, {10, 10}, {20, 20}};

struct AlignError {
  double turn_deg = 0;
  double shift_mm = 0;  ///< of the centroid of the moved scan
  /// The published poses are good to a tenth or two of a millimetre.
  [[nodiscard]] bool success() const { return turn_deg <= 0.5 && shift_mm <= 0.5; }
};

/// The scans of a folder that its .conf names, in name order; exits the program where there are none.
[[nodiscard]] std::vector<PublishedScan> read_published(const std::string& folder, const std::string& conf,
                                                        double mm_per_file_unit);

/// All pairs of scans whose overlap is at least `least_overlap`, the smaller scan moved. A sample overlaps
/// when the other scan has one within a millimetre.
[[nodiscard]] std::vector<PairCase> overlapping_pairs(const std::vector<PublishedScan>& scans,
                                                      double least_overlap);

/// The published pose, turned and shifted away from.
[[nodiscard]] RigidTransform off_start(const PairCase& pair, const PublishedScan& moved, const StartClass& by,
                                       std::uint64_t seed);

[[nodiscard]] AlignError error_of(const PairCase& pair, const PublishedScan& moved,
                                  const RigidTransform& on_from_moved);

/// CPU time of this process, seconds.
[[nodiscard]] double cpu_s();

/// One registration method in the table.
struct PairMethod {
  std::string name;
  double prepare_ms = 0;  ///< per scan, CPU
  /// (on, moved, start) -> on_from_moved
  std::function<RigidTransform(std::size_t, std::size_t, const RigidTransform&)> align;
};

/// Runs every method over every pair, start class and start, and prints the table: success per start class,
/// median errors of the successes, CPU per pair; easy pairs and those of low overlap apart.
void print_pair_table(const std::vector<PublishedScan>& scans, const std::vector<PairCase>& pairs,
                      const std::vector<PairMethod>& methods, int starts, std::uint64_t seed, bool verbose);

}  // namespace dubsar::bench
