// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/pin_faults.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/number_text.h"

namespace dubsar {

namespace {

/// Clicks are good to 1 mm; beyond this, and the tip's own size, nothing of a tip was seen there.
constexpr double kMostMissMm = 3.0;
/// Of scans that are named one by one.
constexpr std::size_t kMostNamed = 5;

double nearest_mm(const RangeGrid& grid, const Eigen::Vector3d& place_mm) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      least = std::min(least, (grid.point(i).cast<double>() - place_mm).squaredNorm());
    }
  }
  return std::sqrt(least);
}

Eigen::AlignedBox3d around(const RangeGrid& grid) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      box.extend(grid.point(i).cast<double>());
    }
  }
  return box;
}

/// Of balls that touch, the centres are a diameter apart.
bool in_one_another(const std::vector<PinTip>& tips, double diameter_mm) {
  Eigen::AlignedBox3d box;
  for (const PinTip& tip : tips) {
    box.extend(tip.position_mm);
  }
  return tips.size() > 1 && box.diagonal().norm() < 0.5 * diameter_mm;
}

}  // namespace

std::optional<Error> misplaced_tips(const PinSet& pins, int id, const RangeGrid& measured,
                                    const std::string& name) {
  const auto found = pins.tips.find(id);
  if (found == pins.tips.end() || found->second.empty() || measured.valid_count() == 0) {
    return std::nullopt;
  }
  const std::vector<PinTip>& tips = found->second;
  Error out{ErrorKind::kBadInput, {}, name, "give them in the frame of that scan, in millimetres"};
  // Some that were entered may be hidden in this scan; but not all of them, nor far from it.
  const Eigen::AlignedBox3d box = around(measured);
  const auto outside = std::ranges::count_if(
      tips, [&](const PinTip& tip) { return box.exteriorDistance(tip.position_mm) > box.diagonal().norm(); });
  if (outside > 0) {
    out.what = fmt::format("its pins cannot be right: {} of them lie farther outside of it than it is large",
                           outside);
    return out;
  }
  const double reach_mm = kMostMissMm + pins.tip_diameter_mm;
  if (std::ranges::none_of(
          tips, [&](const PinTip& tip) { return nearest_mm(measured, tip.position_mm) <= reach_mm; })) {
    out.what = fmt::format("its pins cannot be right: none of them lies within {} mm of its samples",
                           short_text(reach_mm, 3));
    return out;
  }
  if (in_one_another(tips, pins.tip_diameter_mm)) {
    out.what = "its pins cannot be right: all of them lie in one another";
    return out;
  }
  return std::nullopt;
}

std::optional<Error> tips_of_no_scan(const PinSet& pins, std::span<const int> ids,
                                     const std::string& pins_file) {
  std::vector<std::string> none;
  for (const auto& [id, tips] : pins.tips) {
    if (std::ranges::find(ids, id) == ids.end()) {
      none.push_back(std::to_string(id));
    }
  }
  if (none.empty()) {
    return std::nullopt;
  }
  const bool some = none.size() > kMostNamed;
  none.resize(std::min(none.size(), kMostNamed));
  return Error{
      ErrorKind::kBadInput,
      fmt::format("it has pins of scan {}{}, which is not there", fmt::join(none, ", "), some ? ", …" : ""),
      pins_file, "see the numbers of the scans, which count from 0"};
}

}  // namespace dubsar
