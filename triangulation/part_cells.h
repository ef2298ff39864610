// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/job.h"

namespace dubsar {

[[nodiscard]] inline Eigen::AlignedBox3f box_of(std::span<const Eigen::Vector3f> positions,
                                                const std::array<std::uint32_t, 3>& face) {
  Eigen::AlignedBox3f box(positions[face[0]]);
  box.extend(positions[face[1]]);
  box.extend(positions[face[2]]);
  return box;
}

/// The faces that have a face of another part, or one of part 0, near them, in order; all others can only
/// touch faces of their own part. `all`: a box around everything; cell_mm: not below the size of most faces;
/// larger ones take time. Of a job that is cancelled some are missing.
[[nodiscard]] std::vector<std::uint32_t> faces_at_stake(std::span<const Eigen::Vector3f> positions,
                                                        std::span<const std::array<std::uint32_t, 3>> faces,
                                                        std::span<const std::uint32_t> part_of_face,
                                                        const Eigen::AlignedBox3f& all, float cell_mm,
                                                        const JobContext& job = {});

}  // namespace dubsar
