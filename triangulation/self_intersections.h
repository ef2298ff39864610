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

/// Pairs of faces (lower index first, sorted) that cut through each other: an edge of one passes through the
/// inside of the other. Faces that share an edge cannot; of those that share a vertex the edges opposite to
/// it are looked at. Faces that only touch, or lie in one plane, are not counted. Faces with an index out of
/// range or a coordinate that is not finite are passed over. Time is that of a sort, however many faces meet
/// in a vertex or an edge, whatever their sizes and however far apart they lie, unless very many lie in one
/// place; memory besides the pairs is below 200 bytes a face.
/// Of a job that is cancelled some may be missing, and they come in any order.
/// With `part_of_face` given, faces of the same part (other than 0) are known not to cut each other, and most
/// of the work is spared.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> self_intersections(
    std::span<const Eigen::Vector3f> positions, std::span<const std::array<std::uint32_t, 3>> faces,
    std::span<const std::uint32_t> part_of_face = {}, const JobContext& job = {},
    const CountWork& counted = {});

}  // namespace dubsar
