// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/viewer/hand.h"

#include <algorithm>
#include <cmath>

#include "core/tablet_sides.h"

namespace dubsar::ui {

bool use_hand(ImVec2 origin, ImVec2 size, OrbitCamera& camera, Look& look, bool& dragged) {
  const ImGuiIO& io = ImGui::GetIO();
  bool moved_camera = false;
  const auto part = [&](ImVec2 at) {
    return Eigen::Vector2f((at.x - origin.x - 0.5F * size.x) / (0.5F * size.y),
                           -(at.y - origin.y - 0.5F * size.y) / (0.5F * size.y));
  };
  const bool moved = io.MouseDelta.x != 0 || io.MouseDelta.y != 0;
  if (ImGui::IsItemActivated()) {
    dragged = false;
  }
  if (ImGui::IsItemActive() && moved) {
    dragged = dragged || ImGui::IsMouseDragging(ImGuiMouseButton_Left, 3) ||
              ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle);
    if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
      // As one moves a lamp over the tablet: in the middle it stands above, at the rim it rakes.
      const Eigen::Vector2f at = part(io.MousePos);
      const float out = std::min(0.985F, at.norm());
      const Eigen::Vector2f along =
          at.norm() > 1e-3F ? Eigen::Vector2f(at.normalized()) : Eigen::Vector2f(0, 1);
      look.lamp = true;
      look.light = {along.x() * out, along.y() * out, std::sqrt(1 - out * out)};
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || io.KeyShift) {
      moved_camera = true;
      camera.pan({io.MouseDelta.x, io.MouseDelta.y}, size.y);
    } else if (dragged) {
      moved_camera = true;
      camera.drag(part({io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y}),
                  part(io.MousePos));
    }
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
    moved_camera = true;
    const Eigen::Vector2f at = part(io.MousePos);
    camera.zoom(std::pow(0.88F, io.MouseWheel), {at.x() * size.y / size.x, at.y()}, size.x / size.y);
  }
  return moved_camera;
}

void draw_scale_bar(const UiContext& ui, const OrbitCamera& camera, ImVec2 origin, ImVec2 size) {
  const double mm_per_px = static_cast<double>(camera.mm_per_px(size.y));
  // 1, 2 or 5 times a power of ten that takes about a fifth of the picture.
  const double wanted = 0.2 * static_cast<double>(size.x) * mm_per_px;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double length_mm = wanted / power >= 5 ? 5 * power : wanted / power >= 2 ? 2 * power : power;
  const float px = static_cast<float>(length_mm / mm_per_px);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float y = origin.y + size.y - ui.px(1.1F);
  const float x = origin.x + ui.px(1);
  const float height = ui.px(0.35F);
  const ImU32 ink = packed(ui.colours.text);
  for (int k = 0; k < 5; ++k) {
    const float from = x + px * static_cast<float>(k) / 5;
    const float to = x + px * static_cast<float>(k + 1) / 5;
    if (k % 2 == 0) {
      draw->AddRectFilled({from, y}, {to, y + height}, ink);
    } else {
      draw->AddRect({from, y}, {to, y + height}, ink);
    }
  }
  draw->AddText({x + px + ui.px(0.4F), y - ui.px(0.35F)}, ink,
                decimal(fmt::format("{:g} mm", length_mm), ui.preferences.language).c_str());
}

}  // namespace dubsar::ui
