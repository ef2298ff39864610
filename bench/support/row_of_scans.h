// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "bench/support/true_scans.h"

namespace dubsar::bench {

/// One face of a long simulated tablet, scanned piece by piece along its x.
struct RowOptions {
  Eigen::Vector3d size_mm{70, 18, 10};
  int scans = 5;        ///< in a row
  double share = 0.25;  ///< of what a scan shows along x, that the next one shows, too
  double spacing_mm = 0.2;
  double noise_mm = 0.02;
  std::uint64_t seed = 1;
  int sets = 2;  ///< rows of the one tablet, with other noise at every place

  [[nodiscard]] double scan_mm() const { return size_mm.x() / (scans - (scans - 1) * share); }
  /// Where scan k begins to show the tablet, in the tablet's frame.
  [[nodiscard]] double begin_mm(int k) const { return -0.5 * size_mm.x() + k * scan_mm() * (1 - share); }
  /// The middle of what scans k - 1 and k share.
  [[nodiscard]] double seam_mm(int k) const { return begin_mm(k) + 0.5 * scan_mm() * share; }
};

/// Scans the whole obverse once for each place, and cuts the pieces out by the true x of whole columns: set s
/// has at place k of scan k + s. Exits the program when it cannot.
[[nodiscard]] std::vector<std::vector<TrueScan>> rows_of_scans(const RowOptions& options);

}  // namespace dubsar::bench
