// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/scan_list.h"
#include "planning/sparse_flags.h"

namespace dubsar {

SampleFlags without_foreign(const RangeGrid& grid, SampleFlags flags, const std::vector<Matter>& matter) {
  for (std::size_t i = 0; i < matter.size() && i < flags.size(); ++i) {
    if (matter[i] == Matter::kForeign) {
      flags[i] |= kNotTablet;
    }
  }
  reflag_sparse(grid, flags);
  for (std::size_t i = 0; i < matter.size() && i < flags.size(); ++i) {
    if (matter[i] == Matter::kDoubtful && (flags[i] & kNotTablet) == 0) {
      flags[i] |= kPotentiallySparse | kSparse;
    }
  }
  return flags;
}

void TabletFlags::add(const StationScan& scan) {
  scans_[scan.id] = scan;
  now_[scan.id] = scan.flags;
  matter_.add(scan.id, *scan.grid, *scan.flags);
}

std::vector<int> TabletFlags::follow(std::span<const ScanPose> poses) {
  foreign_ = matter_.find(poses);
  std::vector<int> changed;
  for (auto& [id, flags] : now_) {
    const StationScan& scan = scans_.at(id);
    const bool is_found = std::ranges::find(foreign_, id, &ForeignFound::id) != foreign_.end();
    std::shared_ptr<const SampleFlags> then =
        is_found ? std::make_shared<const SampleFlags>(
                       without_foreign(*scan.grid, *scan.flags, matter_.matter(id, *scan.grid)))
                 : scan.flags;
    if (then != flags && *then != *flags) {
      flags = std::move(then);
      changed.push_back(id);
    }
  }
  return changed;
}

std::string reason_of_all(const ForeignFound& found) {
  return fmt::format(
      "all of it stands in the way of {}: its pose is wrong, or something lay over all of it; register it "
      "again",
      listed(found.witnesses));
}

std::string sentence_of(const ForeignFound& found) {
  constexpr double kNothingMm2 = 0.5;
  if (found.is_all()) {
    return fmt::format("scan {}: {}", found.id, reason_of_all(found));
  }
  std::string text = fmt::format("something was in the way of scan {}: ", found.id);
  if (found.foreign_mm2 >= kNothingMm2) {
    text += fmt::format("{:.0f} mm² of it are left out (looked through by {})", found.foreign_mm2,
                        listed(found.witnesses));
  }
  if (found.doubtful_mm2 >= kNothingMm2) {
    text += fmt::format("{}{:.0f} mm² may be of it or of the tablet and stay red until another scan tells",
                        found.foreign_mm2 >= kNothingMm2 ? "; " : "", found.doubtful_mm2);
  }
  return text;
}

}  // namespace dubsar
