// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "station/shown_pins.h"
#include "ui/shell/widgets.h"
#include "ui/view/orbit_camera.h"

namespace dubsar::ui {

/// Draws pins and places on the rim with their labels over a picture of the model. What stands behind the
/// middle of the model is fainter: it may be hidden by it.
void draw_pin_marks(UiContext& ui, const OrbitCamera& camera, ImVec2 origin, ImVec2 size,
                    const std::vector<ShownPin>& pins);

}  // namespace dubsar::ui
