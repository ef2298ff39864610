// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/face_runs.h"

namespace dubsar::ui {

namespace {

bool is_outside(const Eigen::AlignedBox3f& box, const Eigen::Matrix4f& clip_from_model) {
  const Eigen::Vector2f middle = (clip_from_model * box.center().homogeneous()).head<2>();
  const Eigen::Vector2f reach = 0.5F * clip_from_model.topLeftCorner<2, 3>().cwiseAbs() * box.sizes();
  return ((middle.cwiseAbs() - reach).array() > 1.0F).any();
}

}  // namespace

std::vector<FaceRun> seen_runs(std::span<const FaceBlock> blocks, const Eigen::Matrix4f& clip_from_model) {
  std::vector<FaceRun> runs;
  for (const FaceBlock& block : blocks) {
    if (is_outside(block.box_mm, clip_from_model)) {
      continue;
    }
    if (!runs.empty() && runs.back().first + runs.back().count == block.first) {
      runs.back().count += block.count;
    } else {
      runs.push_back({block.first, block.count});
    }
  }
  return runs;
}

std::size_t faces_in(std::span<const FaceRun> runs) {
  std::size_t count = 0;
  for (const FaceRun& run : runs) {
    count += run.count;
  }
  return count;
}

std::size_t level_within(const std::vector<std::vector<FaceBlock>>& levels,
                         const Eigen::Matrix4f& clip_from_model, std::size_t most_faces) {
  std::size_t level = 0;
  while (level + 1 < levels.size() && faces_in(seen_runs(levels[level + 1], clip_from_model)) <= most_faces) {
    ++level;
  }
  return level;
}

}  // namespace dubsar::ui
