// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <vector>

#include "core/red_map.h"

namespace dubsar {

/// Tells when scans no longer bring anything. The planner tries each place from elsewhere, which takes many
/// scans where light does not come back; who stands beside it sees earlier what is the matter.
class VainScans {
 public:
  /// The red map after each scan, what that scan was predicted to clear (nothing: it was not asked for), and
  /// what of that red it did clear. True when the last three that were asked for, together, cleared less than
  /// two fifths of what was predicted and made red smaller by less than a tenth of it (what one clears of a
  /// cavity its border shows anew), and nine tenths of what is left are one place, or no view clears it.
  [[nodiscard]] bool after(const RedMap& map, std::optional<double> predicted_mm2, double cleared_mm2);

 private:
  struct Scan {
    double red_before_mm2 = 0;
    double predicted_mm2 = 0;
    double cleared_mm2 = 0;
  };
  std::vector<Scan> asked_;  ///< the latest three
  std::optional<double> red_mm2_;
};

}  // namespace dubsar
