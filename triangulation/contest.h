// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/owned_scan.h"

namespace dubsar {

/// By node: which of a scan's pairs keep something that samples of the node may have to do with: 1 near it, 2
/// right where it is.
struct Contest {
  std::vector<std::vector<std::uint8_t>> by_pair;
  std::vector<std::uint8_t> any;  ///< 1 where one of them does
};
[[nodiscard]] Contest contest_of(const std::vector<OwnedScan>& scans, std::size_t self);

/// Nodes of another scan within which the pairs of one node's samples lie.
[[nodiscard]] int reach_nodes(const StitchSurface& s, const StitchSurface& other);

/// True when sample i lies within the clearance (× the coarser µ) of, or inside, what another scan keeps.
[[nodiscard]] bool is_taken(const std::vector<OwnedScan>& scans, std::size_t self, std::size_t i,
                            const Contest& contest, double clearance_factor, const OwnershipOptions& options);

/// True when a triangle of another scan's patch meets the triangle t of this one, seen along its normal;
/// `points`: this scan's, [rows*cols].
[[nodiscard]] bool meets_another(const std::vector<OwnedScan>& scans, std::size_t self,
                                 std::span<const Eigen::Vector3f> points, const std::array<std::size_t, 3>& t,
                                 const Contest& contest, const OwnershipOptions& options);

}  // namespace dubsar
