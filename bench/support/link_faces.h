// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar::bench {

/// The triangles of links (seed 001, 4: the link of a vertex is the ordered list of those that it is
/// connected to). `edges` are pairs of vertices, each once; the order around a vertex is that across `axes`
/// [V], seen from outside. A triangle is three vertices each two of which follow one another in the link of
/// the third, less than half a turn on. So no edge has more than two faces, and those two agree on which side
/// is out.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> faces_of_links(
    std::span<const Eigen::Vector3f> positions, std::span<const Eigen::Vector3f> axes,
    std::span<const std::array<std::uint32_t, 2>> edges);

}  // namespace dubsar::bench
