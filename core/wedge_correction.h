// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace dubsar {

enum class CorrectionKind { kDelete, kMerge, kSplit, kAdd };

/// What a person says about the wedges that were found (docs/formats/corrections.md). Everything is said by
/// places on the clay, model frame, so that it can be said again of wedges that were measured anew.
struct WedgeCorrection {
  CorrectionKind kind = CorrectionKind::kDelete;
  /// Depth points of the wedges that are meant: of one or more to delete, of two or more to merge, of the one
  /// to split.
  std::vector<Eigen::Vector3d> at_mm;
  /// A place in each of the wedges that a split gives, at least two: best their deepest.
  std::vector<Eigen::Vector3d> into_mm;
  /// Where a wedge is to be added: all clay within `reach_mm` of these places, at least one.
  std::vector<Eigen::Vector3d> region_mm;
  double reach_mm = 0;
};

/// A correction that could not be made, and why.
struct LostCorrection {
  std::size_t index = 0;  ///< in the list of corrections, from 0
  std::string reason;
};

}  // namespace dubsar
