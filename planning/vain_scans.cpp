// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/vain_scans.h"

#include <algorithm>

namespace dubsar {

namespace {

constexpr std::size_t kScans = 3;
constexpr double kLeastCleared = 0.4;   ///< of what was predicted
constexpr double kLeastProgress = 0.1;  ///< likewise: by how much less is red
constexpr double kNearlyAll = 0.9;      ///< of the red area

}  // namespace

bool VainScans::after(const RedMap& map, std::optional<double> predicted_mm2, double cleared_mm2) {
  double red_mm2 = 0;
  double largest_mm2 = 0;
  double silent_mm2 = 0;
  for (const RedRegion& region : map.regions) {
    if (region.state == RegionState::kRed) {
      red_mm2 += region.area_mm2;
      largest_mm2 = std::max(largest_mm2, region.area_mm2);
      silent_mm2 += region.reason.empty() ? 0.0 : region.area_mm2;  // a red place has no other reason
    }
  }
  if (predicted_mm2 && red_mm2_) {
    asked_.push_back({*red_mm2_, *predicted_mm2, cleared_mm2});
    if (asked_.size() > kScans) {
      asked_.erase(asked_.begin());
    }
  }
  red_mm2_ = red_mm2;
  if (map.conclusive || !predicted_mm2 || asked_.size() < kScans) {
    return false;
  }
  double promised_mm2 = 0;
  double brought_mm2 = 0;
  for (const Scan& scan : asked_) {
    promised_mm2 += scan.predicted_mm2;
    brought_mm2 += scan.cleared_mm2;
  }
  const double gone_mm2 = asked_.front().red_before_mm2 - red_mm2;
  return brought_mm2 < kLeastCleared * promised_mm2 && gone_mm2 < kLeastProgress * promised_mm2 &&
         std::max(largest_mm2, silent_mm2) >= kNearlyAll * red_mm2;
}

}  // namespace dubsar
