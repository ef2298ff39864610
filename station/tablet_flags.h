// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/sample_flags.h"
#include "core/scan_pose.h"
#include "registration/foreign_matter.h"
#include "station/station_scan.h"

namespace dubsar {

/// The flags of a scan without what is foreign in it: that is kNotTablet, its neighbours count as at a gap,
/// and what is doubtful is sparse until another scan clears it. `matter` as ForeignMatter has it.
[[nodiscard]] SampleFlags without_foreign(const RangeGrid& grid, SampleFlags flags,
                                          const std::vector<Matter>& matter);

/// For people: what was left out, why, and what remains to be done.
[[nodiscard]] std::string sentence_of(const ForeignFound& found);
/// The same of a scan of which nothing is left (ForeignFound::is_all()), without its name.
[[nodiscard]] std::string reason_of_all(const ForeignFound& found);

/// The flags of many scans, each without what the others show to be foreign in it, as the poses come and go.
class TabletFlags {
 public:
  /// Makes a scan known; replaces it when it is.
  void add(const StationScan& scan);
  /// Follows the poses. The scans whose flags are others now: no one may point to theirs any more.
  std::vector<int> follow(std::span<const ScanPose> poses);
  /// Of a known scan; stay where they are until follow() names it or add() replaces it.
  [[nodiscard]] const SampleFlags& of(int id) const { return *now_.at(id); }
  /// Scans in which something foreign was found, by id.
  [[nodiscard]] const std::vector<ForeignFound>& foreign() const { return foreign_; }
  /// Registered scans with the very samples of another, as the last follow() had it: they count as that one.
  [[nodiscard]] const std::vector<ScanCopy>& copies() const { return matter_.copies(); }

 private:
  std::map<int, StationScan> scans_;
  std::map<int, std::shared_ptr<const SampleFlags>> now_;
  ForeignMatter matter_;
  std::vector<ForeignFound> foreign_;
};

}  // namespace dubsar
