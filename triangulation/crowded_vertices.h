// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/job.h"
#include "triangulation/count_work.h"

namespace dubsar {

/// The faces at vertices where so many meet that their boxes, all of which hold the vertex, tell nothing
/// apart: takes them out of `which` and returns the pairs (lower face first, in any order) in which one of
/// them and another of `which` cut through each other, as faces_cut() has it. Seen from such a vertex, a face
/// at it is an arc on the unit sphere, and only faces whose boxes on the sphere touch can cut: time is that
/// of a sort for each such vertex; nor are those compared that share one of the edges at it where very many
/// meet. The faces must be sound. Of a job that is cancelled some pairs are missing.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> take_cuts_at_crowded_vertices(
    std::span<const Eigen::Vector3f> positions, std::span<const std::array<std::uint32_t, 3>> faces,
    std::vector<std::uint32_t>& which, const JobContext& job = {}, const CountWork& counted = {});

}  // namespace dubsar
