// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <imgui.h>

#include <Eigen/Core>
#include <optional>

#include "core/range_grid.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// The valid sample of a grid nearest to a place in its picture (parts of its width and height), no farther
/// than some cells: a click beside the clay takes what it was meant for. Scanner frame, mm.
[[nodiscard]] std::optional<Eigen::Vector3d> sample_at(const RangeGrid& grid, float u, float v);

/// Where the sample nearest to a point stands in the picture of the grid, in parts.
[[nodiscard]] std::optional<ImVec2> place_of(const RangeGrid& grid, const Eigen::Vector3d& point_mm);

/// The picture of a grid, as large as fits, on which places are clicked.
struct ClickablePicture {
  ImVec2 origin, drawn;           ///< on the screen
  std::optional<ImVec2> clicked;  ///< just now, in parts
  [[nodiscard]] ImVec2 at(ImVec2 place) const {
    return {origin.x + place.x * drawn.x, origin.y + place.y * drawn.y};
  }
};
[[nodiscard]] ClickablePicture draw_clickable(UiContext& ui, const char* name, const RangeGrid& grid,
                                              const PixelTexture& texture, const Eigen::Vector4f& frame,
                                              float frame_px, ImVec2 size);

}  // namespace dubsar::ui
