// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar {

/// A permutation of the faces, [faces], that puts neighbours in space next to each other: by the cell (of 64
/// along the longest side of the box) of their first vertex in Z order, and as they were within a cell. All
/// indices must be in range and all positions finite. The same for any number of threads.
[[nodiscard]] std::vector<std::uint32_t> order_by_place(std::span<const Eigen::Vector3f> positions_mm,
                                                        std::span<const std::array<std::uint32_t, 3>> faces,
                                                        const Eigen::AlignedBox3f& box_mm);

}  // namespace dubsar
