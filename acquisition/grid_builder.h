// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

#include "core/range_grid.h"
#include "drivers/device.h"

namespace dubsar {

/// What was odd about the profiles of a scan; nothing of it stops a scan.
struct ProfileFaults {
  std::uint64_t rows_lost = 0;      ///< gaps in the row numbers, kept as empty rows
  std::uint64_t rows_repeated = 0;  ///< numbers that came before, left out
  std::uint64_t odd_lengths =
      0;  ///< more or fewer samples than announced: cut, or filled up with empty cells
  std::uint64_t bad_samples = 0;  ///< said to be valid and not finite or beyond a kilometre: invalid
};

/// Puts a grid together from the profiles of one organised scan. The grid is complete up to its last row
/// after every append.
class GridBuilder {
 public:
  explicit GridBuilder(const ScanInfo& info);

  /// Appends the profile, behind empty rows where numbers are missing. False when it was left out as a
  /// repetition.
  bool append(const Profile& profile);
  /// µ where the device told none, from what is there by now; estimated anew as the rows double.
  void estimate_spacing();

  [[nodiscard]] const RangeGrid& grid() const { return grid_; }
  [[nodiscard]] RangeGrid take() { return std::move(grid_); }
  [[nodiscard]] const ProfileFaults& faults() const { return faults_; }

 private:
  void append_empty_rows(std::size_t count);

  RangeGrid grid_;
  ProfileFaults faults_;
  bool spacing_known_ = false;
  int next_estimate_ = 2;
};

}  // namespace dubsar
