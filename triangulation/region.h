// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "triangulation/draft.h"
#include "triangulation/front.h"
#include "triangulation/tiling.h"

namespace dubsar {

/// A part of a draft, taken out to be worked on: time goes with its size, not with that of the draft.
class Region {
 public:
  Sheet sheet;

  /// Number in the draft of a vertex of the sheet that came from there.
  [[nodiscard]] std::uint32_t vertex(std::uint32_t local) const { return vertices_[local]; }
  /// The sheet's number of a vertex of the draft that is whole here.
  [[nodiscard]] std::uint32_t local(std::uint32_t vertex) const;
  [[nodiscard]] std::uint32_t face(std::size_t local) const { return faces_[local]; }
  /// Whose tile this is.
  [[nodiscard]] std::size_t tile() const { return tile_; }
  /// How many vertices of the sheet came from the draft: the first.
  [[nodiscard]] std::size_t taken() const { return vertices_.size(); }
  /// Takes away faces that came from the draft and lie in the room of the sheet: those with gone[face of the
  /// sheet] != 0. Before any is added. Returns how many.
  std::size_t erase(std::span<const std::uint8_t> gone, Draft& draft);
  /// Brings what was added to the sheet into the draft; `interpolated`: the sheet's first such vertex.
  void put_back(Draft& draft, std::size_t interpolated) const;

 private:
  friend std::vector<Region> take_regions(const Draft& draft, std::span<const std::uint8_t> near,
                                          const Tiling& tiling);
  /// Takes vertices_ and faces_ as they are and fills the rest; `local_of`: of its whole vertices.
  void fill(const Draft& draft, std::span<const std::uint32_t> local_of,
            std::span<const std::uint32_t> tile_of, const Eigen::AlignedBox3f& room, std::size_t tile);

  std::size_t tile_ = 0;
  std::size_t whole_ = 0;                ///< vertices all of whose faces are here: the first
  std::vector<std::uint32_t> vertices_;  ///< by vertex of the sheet; the whole ones ascending, then the rest
  std::vector<std::uint32_t> faces_;     ///< by face of the sheet, of those that came from the draft
};

/// All faces around the vertices v with near[v] != 0, by the tile that v lies in: a vertex is whole in one
/// region, a face may be in up to three. Empty tiles are left out.
[[nodiscard]] std::vector<Region> take_regions(const Draft& draft, std::span<const std::uint8_t> near,
                                               const Tiling& tiling);

/// [V] 1 for vertices within 6 µ of one of the seeds, 0 for those that are far.
[[nodiscard]] std::vector<std::uint8_t> vertices_near(const Draft& draft,
                                                      std::span<const std::uint32_t> seeds);

}  // namespace dubsar
