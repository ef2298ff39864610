// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/support/pinned_scans.h"

namespace dubsar::bench {

/// Of dubsar-pins.
struct PinArguments {
  std::string kind = "text";
  std::uint64_t first_seed = 1;
  std::uint64_t tablets = 4;
  int views = 12;
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  double tip_mm = 1.0;
  bool verbose = false;
  std::uint64_t matching = 0;
};

struct ScanPairSums {
  std::size_t pairs = 0, right = 0;                ///< of two scans that share four true tips that both found
  std::size_t scans = 0, with_any = 0, first = 0;  ///< scans with a right start on the earlier ones, merged
  std::size_t starts = 0;
};

/// Matches the detected tips of all scans of one tablet, with labels as an operator clicks them or without.
void match_scans(const PinArguments& arguments, const std::vector<PinnedScan>& scans, bool labels,
                 const std::string& name, ScanPairSums& sums);

/// Placements of the pins alone, without scans: how often matching finds the right one, and how soon.
void measure_matching(const PinArguments& arguments);

[[nodiscard]] inline double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace dubsar::bench
