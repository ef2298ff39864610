// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "registration/pose_search.h"
#include "registration/scan_model.h"

namespace dubsar {

/// A second look at a pose that is refused although its relief leaves no doubt: free space speaks against it
/// where hands hold the tablet. With all scans of both groups in their places, what ForeignMatter tells to be
/// foreign is left out of each, and the pose is refined and judged by the same rules without it. Clay that
/// stands in the air because the pose is wrong would be left out, too: so the relief must settle the pose
/// alone, with no rival, the scan must not have moved while it was scanned, and only so much may be left out.
/// What was left out of the scans goes back in unless keep() is called.
class ScanModel::WithoutForeign {
 public:
  /// `ids` are the members of the group that the scan is to join.
  WithoutForeign(ScanModel& model, int id, std::vector<int> ids);
  ~WithoutForeign();
  WithoutForeign(const WithoutForeign&) = delete;
  WithoutForeign& operator=(const WithoutForeign&) = delete;

  /// A SecondLook.
  bool settles(FoundPose& found);
  /// The scan and those of `ids` as they were entered.
  [[nodiscard]] const ScanSurface& whole() const { return model_.whole_of(id_); }
  [[nodiscard]] std::vector<ModelScan> whole_model() const;
  void keep();

 private:
  using Marks = std::vector<std::uint8_t>;

  [[nodiscard]] const ModelFit* candidate(const FoundPose& found) const;
  /// The foreign cells of the fine levels, by scan; nothing where there are none or too many.
  [[nodiscard]] std::optional<std::map<int, Marks>> foreign_at(
      const RigidTransform& group_from_scanner) const;
  void leave_out(std::map<int, Marks> marks);
  void put_back();

  ScanModel& model_;
  int id_;
  std::vector<int> ids_;
  std::map<int, std::pair<ScanFeatures, Marks>> before_;
  std::vector<RigidTransform> looked_at_;
};

}  // namespace dubsar
