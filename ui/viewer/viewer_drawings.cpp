// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is drawn over the surface: wedges as lines, the tape, the scale bar, the legend.
#include <algorithm>
#include <array>
#include <cmath>

#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

/// Labels of more wedges than this would hide the tablet.
constexpr int kMostLabels = 90;

struct ToPicture {
  const OrbitCamera& camera;
  ImVec2 origin;
  ImVec2 size;
  [[nodiscard]] ImVec2 operator()(const Eigen::Vector3d& point_mm) const {
    const Eigen::Vector2f px = camera.pixel_of(point_mm.cast<float>(), {size.x, size.y});
    return {origin.x + px.x(), origin.y + px.y()};
  }
};

bool faces_viewer(const Wedge& wedge, const OrbitCamera& camera) {
  return (camera.eye_from_model * wedge.surface_normal.cast<float>()).z() > 0.05F;
}

}  // namespace

void ViewerScreen::draw_wedges(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  const ToPicture at{camera_, origin, size};
  ImDrawList* draw = ImGui::GetWindowDrawList();
  int in_view = 0;
  for (const Wedge& wedge : *state_.wedges) {
    const ImVec2 p = at(wedge.depth_point_mm);
    in_view += faces_viewer(wedge, camera_) && p.x > origin.x && p.y > origin.y && p.x < origin.x + size.x &&
                       p.y < origin.y + size.y
                   ? 1
                   : 0;
  }
  const ImU32 outer = packed(ui.colours.outline, 0.9F);
  const ImU32 inner = packed({0.05F, 0.05F, 0.07F, 1}, 0.9F);
  const ImU32 directional = packed(ui.colours.red);
  const ImU32 strong = packed(ui.colours.ghost);
  for (std::size_t k = 0; k < state_.wedges->size(); ++k) {
    const Wedge& wedge = (*state_.wedges)[k];
    if (!faces_viewer(wedge, camera_)) {
      continue;
    }
    const bool chosen =
        static_cast<int>(k) == wedge_ || std::ranges::find(marked_, static_cast<int>(k)) != marked_.end();
    const float width = chosen ? 3.0F : 1.4F;
    const ImVec2 deep = at(wedge.depth_point_mm);
    for (std::size_t e = 0; e < 3; ++e) {
      draw->AddLine(at(wedge.outer_vertices_mm[e]), at(wedge.outer_vertices_mm[(e + 1) % 3]),
                    chosen ? strong : outer, width);
      const bool leads = static_cast<int>(e) == wedge.directional_edge;
      draw->AddLine(deep, at(wedge.exit_points_mm[e]), leads ? directional : inner,
                    leads ? 1.3F * width : width);
    }
    if (chosen || in_view <= kMostLabels) {
      draw->AddText(ui.fonts.small, ui.fonts.small->FontSize, {deep.x + 4, deep.y + 2},
                    chosen ? strong : outer, std::to_string(wedge.id).c_str());
    }
  }
}

int ViewerScreen::wedge_at(const Eigen::Vector2f& px, ImVec2 size) const {
  if (!state_.wedges || !show_wedges_) {
    return -1;
  }
  const ToPicture at{camera_, {0, 0}, size};
  int best = -1;
  float nearest = 30;  // pixels
  for (std::size_t k = 0; k < state_.wedges->size(); ++k) {
    const Wedge& wedge = (*state_.wedges)[k];
    if (!faces_viewer(wedge, camera_)) {
      continue;
    }
    const ImVec2 deep = at(wedge.depth_point_mm);
    const float far_px = std::hypot(deep.x - px.x(), deep.y - px.y());
    if (far_px < nearest) {
      nearest = far_px;
      best = static_cast<int>(k);
    }
  }
  return best;
}

void ViewerScreen::draw_tape(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  const ToPicture at{camera_, origin, size};
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 ink = packed(ui.colours.ghost);
  for (const Eigen::Vector3f& place : tape_) {
    draw->AddCircleFilled(at(place.cast<double>()), ui.px(0.3F), ink);
  }
  if (tape_.size() == 2) {
    ui.facts.insert("measured");
    const ImVec2 a = at(tape_[0].cast<double>());
    const ImVec2 b = at(tape_[1].cast<double>());
    draw->AddLine(a, b, ink, 2.5F);
    if (tool_ == Tool::kSection) {
      return;  // the plot says the length of its cut, which runs along the plane of view
    }
    const std::string words =
        fmt::format("{} mm", decimal((tape_[1] - tape_[0]).norm(), 3, ui.preferences.language));
    const ImVec2 box = ImGui::CalcTextSize(words.c_str());
    const ImVec2 middle{0.5F * (a.x + b.x), 0.5F * (a.y + b.y) + ui.px(0.3F)};
    draw->AddRectFilled({middle.x - 4, middle.y - 2}, {middle.x + box.x + 4, middle.y + box.y + 2},
                        packed(ui.colours.panel, 0.85F), 3);
    draw->AddText(middle, ink, words.c_str());
  }
}

void ViewerScreen::draw_polygon(UiContext& ui, ImVec2 origin) const {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 ink = packed(ui.colours.ghost);
  const auto at = [&](std::size_t k) {
    return ImVec2{origin.x + polygon_[k].x(), origin.y + polygon_[k].y()};
  };
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const ImVec2 a = at(k);
    const ImVec2 b = k + 1 < polygon_.size() ? at(k + 1) : polygon_closed_ ? at(0) : ImGui::GetIO().MousePos;
    draw->AddLine(a, b, ink, 2);
    draw->AddCircleFilled(a, k == 0 ? 6.0F : 4.0F, ink);
  }
}

void ViewerScreen::draw_flags_legend(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  ui.facts.insert("legend");
  const ImFont* font = ui.fonts.small;
  const float line = 1.4F * font->FontSize;
  const std::pair<Text, Eigen::Vector4f> lines[] = {{Text::kSparse, ui.colours.red},
                                                    {Text::kFilledIn, ui.colours.amber}};
  float wide = 0;
  for (const auto& [text, colour] : lines) {
    wide = std::max(wide, font->CalcTextSizeA(font->FontSize, 1e4F, 0, ui.text(text)).x);
  }
  wide += 1.5F * line + ui.px(0.4F);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImVec2 at{origin.x + size.x - wide - ui.px(0.8F), origin.y + ui.px(0.7F)};
  draw->AddRectFilled({at.x - ui.px(0.4F), at.y - ui.px(0.3F)}, {at.x + wide, at.y + 2 * line + ui.px(0.3F)},
                      packed(ui.colours.panel, 0.85F), 4);
  for (const auto& [text, colour] : lines) {
    draw->AddRectFilled({at.x, at.y + 0.2F * line}, {at.x + 0.9F * line, at.y + 0.85F * line},
                        packed(colour));
    draw->AddText(font, font->FontSize, {at.x + 1.3F * line, at.y + 0.15F * line}, packed(ui.colours.text),
                  ui.text(text));
    at.y += line;
  }
}

namespace {

/// Of what a field's numbers are; empty where they are shares or ranks.
const char* unit_of(MeshField field) {
  switch (field) {
    case MeshField::kMeanCurvature:
      return "1/mm";
    case MeshField::kSigma:
    case MeshField::kHeight:
      return "mm";
    default:
      return "";
  }
}

}  // namespace

void ViewerScreen::draw_legend(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  if (look_.overlay == Overlay::kFlags) {
    draw_flags_legend(ui, origin, size);
  }
  const bool ranged = look_.overlay == Overlay::kValue || look_.overlay == Overlay::kReliability ||
                      look_.overlay == Overlay::kScans;
  if (!ranged) {
    return;
  }
  static const auto kColours = overlay_colours();
  const Eigen::Vector2f range = look_.overlay == Overlay::kValue         ? look_.value_range
                                : look_.overlay == Overlay::kReliability ? Eigen::Vector2f(0, 1)
                                                                         : Eigen::Vector2f(0, 8);
  ui.facts.insert("legend");
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float height = std::min(0.5F * size.y, ui.px(14));
  const float width = ui.px(0.9F);
  const ImVec2 at{origin.x + size.x - ui.px(1) - width, origin.y + ui.px(1)};
  const char* unit = look_.overlay == Overlay::kValue && field_ ? unit_of(*field_) : "";
  const float foot = ui.px(0.7F) + (*unit != '\0' ? ui.fonts.small->FontSize : 0.0F);
  // On a ground of its own: the surface may lie behind it.
  draw->AddRectFilled({at.x - ui.px(3.6F), at.y - ui.px(0.7F)},
                      {origin.x + size.x - ui.px(0.4F), at.y + height + foot},
                      packed(ui.colours.panel, 0.85F), 4);
  constexpr int kSteps = 64;
  for (int k = 0; k < kSteps; ++k) {
    const auto& c = kColours[static_cast<std::size_t>(255 * k / (kSteps - 1))];
    const float low = at.y + height * static_cast<float>(kSteps - 1 - k) / kSteps;
    draw->AddRectFilled({at.x, low}, {at.x + width, low + height / kSteps + 1},
                        IM_COL32(c[0], c[1], c[2], 255));
  }
  for (int k = 0; k <= 4; ++k) {
    const float part = static_cast<float>(k) / 4;
    const std::string words =
        decimal(fmt::format("{:.3g}", range.x() + part * (range.y() - range.x())), ui.preferences.language);
    const ImVec2 box = ui.fonts.small->CalcTextSizeA(ui.fonts.small->FontSize, 1e4F, 0, words.c_str());
    draw->AddText(ui.fonts.small, ui.fonts.small->FontSize,
                  {at.x - box.x - ui.px(0.3F), at.y + (1 - part) * height - 0.5F * box.y},
                  packed(ui.colours.text), words.c_str());
  }
  const float unit_wide = ui.fonts.small->CalcTextSizeA(ui.fonts.small->FontSize, 1e4F, 0, unit).x;
  draw->AddText(ui.fonts.small, ui.fonts.small->FontSize,
                {at.x - unit_wide - ui.px(0.3F), at.y + height + ui.px(0.5F)}, packed(ui.colours.text), unit);
}

}  // namespace dubsar::ui
