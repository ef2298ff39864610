// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "triangulation/draft.h"
#include "triangulation/front.h"

namespace dubsar {

/// A part of a draft, taken out to be worked on: time goes with its size, not with that of the draft.
class Region {
 public:
  /// All faces around the vertices v with near[v] != 0.
  Region(const Draft& draft, std::span<const std::uint8_t> near);

  Sheet sheet;

  /// Number in the draft of a vertex of the sheet that came from there.
  [[nodiscard]] std::uint32_t vertex(std::uint32_t local) const { return vertices_[local]; }
  /// The sheet's number of a vertex of the draft, which must be here.
  [[nodiscard]] std::uint32_t local(std::uint32_t vertex) const;
  [[nodiscard]] std::uint32_t face(std::size_t local) const { return faces_[local]; }
  /// Takes away faces that came from the draft: those with gone[face of the sheet] != 0. Before any is added.
  void erase(std::span<const std::uint8_t> gone, Draft& draft);
  /// Brings what was added to the sheet into the draft; `interpolated`: the sheet's first such vertex.
  void put_back(Draft& draft, std::size_t interpolated) const;

 private:
  std::vector<std::uint32_t> vertices_;  ///< by vertex of the sheet, ascending
  std::vector<std::uint32_t> faces_;     ///< by face of the sheet, of those that came from the draft
};

/// [V] 1 for vertices within 6 µ of one of the seeds, 0 for those that are far.
[[nodiscard]] std::vector<std::uint8_t> vertices_near(const Draft& draft,
                                                      std::span<const std::uint32_t> seeds);

}  // namespace dubsar
