// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar {

/// A surface in fewer faces, between the vertices of the full one.
struct DetailLevel {
  float cell_mm = 0;                                ///< nothing smaller is told apart
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< indices of the full surface's vertices
  std::vector<std::uint32_t> from;                  ///< [faces] the face that each was made of, rising
};

/// Levels of detail by vertex clustering (Rossignac and Borrel 1993): space is cut into cells, of the
/// vertices in a cell the first stands for all, and faces that thereby lose a corner go. The cells of a level
/// hold eight of the next each, so that a level is the same surface wherever it is looked at: no cracks
/// between parts of one level. From about `fewest_faces` up, four times as many at each, while they are less
/// than a third of all; none where `fewest_faces` is more than two thirds of all. All indices must be in
/// range and all positions finite. The same for any number of threads.
[[nodiscard]] std::vector<DetailLevel> detail_levels(std::span<const Eigen::Vector3f> positions_mm,
                                                     std::span<const std::array<std::uint32_t, 3>> faces,
                                                     const Eigen::AlignedBox3f& box_mm,
                                                     std::size_t fewest_faces);

}  // namespace dubsar
