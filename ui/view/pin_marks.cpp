// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/pin_marks.h"

namespace dubsar::ui {

void draw_pin_marks(UiContext& ui, const OrbitCamera& camera, ImVec2 origin, ImVec2 size,
                    const std::vector<ShownPin>& pins) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(origin, {origin.x + size.x, origin.y + size.y}, true);
  const float radius = ui.px(0.4F);
  for (const ShownPin& pin : pins) {
    const Eigen::Vector3f place = pin.position_mm.cast<float>();
    const Eigen::Vector2f px = camera.pixel_of(place, {size.x, size.y});
    const bool behind = (camera.eye_from_model * (place - camera.centre_mm)).z() < 0;
    const float alpha = behind ? 0.45F : 1.0F;
    const ImVec2 at{origin.x + px.x(), origin.y + px.y()};
    const ImU32 shadow = packed({0, 0, 0, 1}, alpha);
    const ImU32 ink = packed({0.45F, 0.75F, 1.0F, 1}, alpha);  // told from clay and from red, on any ground
    const std::string name = pin_name(pin.label);
    if (is_rim_label(pin.label)) {  // a place on the clay: a square; a pin's tip: a ball
      draw->AddRect({at.x - radius, at.y - radius}, {at.x + radius, at.y + radius}, shadow, 0, 0, 4);
      draw->AddRect({at.x - radius, at.y - radius}, {at.x + radius, at.y + radius}, ink, 0, 0, 2);
    } else {
      draw->AddCircle(at, radius, shadow, 0, 4);
      draw->AddCircle(at, radius, ink, 0, 2);
    }
    const ImVec2 text{at.x + 1.4F * radius, at.y - 0.5F * ImGui::GetTextLineHeight()};
    for (const ImVec2 by : {ImVec2(-1, 0), ImVec2(1, 0), ImVec2(0, -1), ImVec2(0, 1)}) {
      draw->AddText({text.x + by.x, text.y + by.y}, shadow, name.c_str());
    }
    draw->AddText(text, ink, name.c_str());
    ui.facts.insert("pin." + name);
  }
  draw->PopClipRect();
}

}  // namespace dubsar::ui
