// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "core/mesh.h"
#include "core/red_map.h"
#include "ui/shell/widgets.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// How the tablet is to be turned: as it lies now, and ghosted as it is to lie, with an arrow along the turn;
/// seen from where the operator stands. Or, where it stays, from where the scanner looks.
class PosePanel {
 public:
  void show(const ShownMesh& shown);
  /// True while something moves in it.
  bool draw(UiContext& ui, const NextView& next, ImVec2 size);

 private:
  SurfaceView now_, then_;
  Eigen::AlignedBox3f box_mm_;
};

/// Rotations of the tablet on the stage before and after what a view asks for.
struct TurnToMake {
  Eigen::Matrix3f stage_from_model_now;
  Eigen::Matrix3f stage_from_model_then;
  bool by_hand = false;
};
[[nodiscard]] TurnToMake turn_to_make(const NextView& next);

}  // namespace dubsar::ui
