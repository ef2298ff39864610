// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/disjoint_sets.h"
#include "triangulation/front.h"

namespace dubsar {

/// Tells the outer rims of small pieces of surface (the floor of a hole, what is left between fingers) from
/// the rims of small openings: both are short walks along open edges. Holds while no face is added or taken
/// away.
class OuterRims {
 public:
  explicit OuterRims(const Sheet& sheet) : sheet_(&sheet) {}

  /// Whether the walk (Front::walks()) encloses its own piece of surface. True also where that looks so and
  /// parts of the piece are not in the sheet.
  [[nodiscard]] bool contain(const std::vector<std::uint32_t>& walk);

 private:
  void gather_pieces();

  const Sheet* sheet_;
  std::optional<DisjointSets> pieces_;  ///< of vertices, joined by faces
  std::vector<std::uint32_t> faces_;    ///< [vertex] of the piece that it stands for
};

}  // namespace dubsar
