// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <imgui.h>

#include "ui/shell/widgets.h"
#include "ui/view/orbit_camera.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// What the hand does to the picture that was the last item: left drag turns, with shift or the middle button
/// it moves, the wheel comes nearer, right drag moves the lamp. `dragged`: kept between the calls; whether
/// the press that goes on, or ended last, was a drag. True when the camera moved.
bool use_hand(ImVec2 origin, ImVec2 size, OrbitCamera& camera, Look& look, bool& dragged);

/// A bar of a round length, to scale, in the picture's lower left corner.
void draw_scale_bar(const UiContext& ui, const OrbitCamera& camera, ImVec2 origin, ImVec2 size);

}  // namespace dubsar::ui
