// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/grid_places.h"

#include <algorithm>
#include <limits>

namespace dubsar::ui {

namespace {

constexpr int kNearCells = 4;

}  // namespace

std::optional<Eigen::Vector3d> sample_at(const RangeGrid& grid, float u, float v) {
  const int col = static_cast<int>(u * static_cast<float>(grid.cols));
  const int row = static_cast<int>(v * static_cast<float>(grid.rows));
  std::optional<Eigen::Vector3d> out;
  int nearest = kNearCells * kNearCells + 1;
  for (int r = row - kNearCells; r <= row + kNearCells; ++r) {
    for (int c = col - kNearCells; c <= col + kNearCells; ++c) {
      const int far2 = (r - row) * (r - row) + (c - col) * (c - col);
      if (far2 < nearest && grid.is_valid(r, c)) {
        nearest = far2;
        out = grid.point(grid.index(r, c)).cast<double>();
      }
    }
  }
  return out;
}

std::optional<ImVec2> place_of(const RangeGrid& grid, const Eigen::Vector3d& point_mm) {
  std::optional<ImVec2> out;
  double nearest = std::numeric_limits<double>::max();
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t i = grid.index(row, col);
      if (grid.valid[i] == 0) {
        continue;
      }
      const double far2 = (grid.point(i).cast<double>() - point_mm).squaredNorm();
      if (far2 < nearest) {
        nearest = far2;
        out = ImVec2((static_cast<float>(col) + 0.5F) / static_cast<float>(grid.cols),
                     (static_cast<float>(row) + 0.5F) / static_cast<float>(grid.rows));
      }
    }
  }
  return out;
}

ClickablePicture draw_clickable(UiContext& ui, const char* name, const RangeGrid& grid,
                                const PixelTexture& texture, const Eigen::Vector4f& frame, float frame_px,
                                ImVec2 size) {
  const float scale = std::min(size.x / static_cast<float>(std::max(1, grid.cols)),
                               size.y / static_cast<float>(std::max(1, grid.rows)));
  ClickablePicture out;
  out.drawn = {scale * static_cast<float>(grid.cols), scale * static_cast<float>(grid.rows)};
  out.origin = ImGui::GetCursorScreenPos();
  ImGui::PushID(name);
  ImGui::InvisibleButton("##picture", out.drawn);
  ImGui::PopID();
  ui.target(name, Reach::kNone);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 end = out.at({1, 1});
  draw->AddImage(picture_of(texture.id()), out.origin, end);
  draw->AddRect(out.origin, end, packed(frame), 0, 0, frame_px);
  if (ImGui::IsItemClicked()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    out.clicked = {(mouse.x - out.origin.x) / out.drawn.x, (mouse.y - out.origin.y) / out.drawn.y};
  }
  return out;
}

}  // namespace dubsar::ui
