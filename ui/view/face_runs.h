// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "ui/view/shown_mesh.h"

namespace dubsar::ui {

/// Faces that follow each other.
struct FaceRun {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// The faces of the blocks that may be seen under an orthographic `clip_from_model`, in as few runs as that
/// gives.
[[nodiscard]] std::vector<FaceRun> seen_runs(std::span<const FaceBlock> blocks,
                                             const Eigen::Matrix4f& clip_from_model);
[[nodiscard]] std::size_t faces_in(std::span<const FaceRun> runs);

/// Of levels of detail, fewest faces first, the finest of which no more than `most_faces` may be seen; the
/// first where there is none. In an orthographic picture a level looks as coarse everywhere, so that one does
/// for all of it.
[[nodiscard]] std::size_t level_within(const std::vector<std::vector<FaceBlock>>& levels,
                                       const Eigen::Matrix4f& clip_from_model, std::size_t most_faces);

}  // namespace dubsar::ui
