// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/viewer/pair_screen.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ui/shell/face_texts.h"
#include "ui/viewer/hand.h"

namespace dubsar::ui {

namespace {

/// What is to be known of a mesh, in red or amber as it is said of one alone.
using Remark = std::pair<Eigen::Vector4f, std::string>;
std::vector<Remark> remarks_on(const UiContext& ui, const ShownMesh& shown,
                               const std::optional<Error>& error) {
  std::vector<Remark> out;
  if (error) {
    out.emplace_back(ui.colours.bad, translated(*error, ui.preferences.language));
  }
  if (shown.left_out > 0) {
    out.emplace_back(ui.colours.amber, filled(ui.text(Text::kLeftOut), grouped(shown.left_out)));
  }
  if (shown.instead_of_faces > 0) {
    out.emplace_back(ui.colours.amber, filled(ui.text(Text::kFewerFaces), grouped(shown.faces.size()),
                                              grouped(shown.instead_of_faces)));
  }
  return out;
}

/// Below each other from `at` on, legible over the clay too.
void draw_remarks(const UiContext& ui, const std::vector<Remark>& remarks, ImVec2 at, float wide) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float letter = ui.fonts.small->FontSize;
  for (const auto& [colour, words] : remarks) {
    const ImVec2 size = ui.fonts.small->CalcTextSizeA(letter, 1e6F, wide, words.c_str());
    draw->AddRectFilled(at, {at.x + size.x, at.y + size.y}, packed(ui.colours.panel, 0.9F), 4);
    draw->AddText(ui.fonts.small, letter, at, packed(colour), words.c_str(), nullptr, wide);
    at.y += size.y + ui.px(0.2F);
  }
}

}  // namespace

PairScreen::PairScreen(MeshViewing& left, MeshViewing& right) {
  panes_[0].viewing = &left;
  panes_[1].viewing = &right;
}

void PairScreen::take_state(UiContext& ui, Pane& pane) {
  if (std::exchange(pane.openness_due, false)) {
    pane.viewing->want(MeshField::kOpenness);
  }
  pane.state = pane.viewing->state();
  bool is_new = false;
  {
    const TimedWork timed(ui.watch, "a mesh to the graphics card");
    is_new = pane.prepared.update(pane.state, pane.surface);
  }
  if (is_new) {
    pane.openness_due = true;
    unfinished_ = true;
    pane.openness.reset();
    if (!pane.prepared.shown().colours.empty()) {
      look_.overlay = Overlay::kColours;
    }
    look_at(Face::kObverse);
  }
  unfinished_ = unfinished_ || pane.prepared.arrives();
  const auto openness = pane.state.fields.find(MeshField::kOpenness);
  if (!pane.surface.empty() && pane.prepared.is_of(pane.state) && openness != pane.state.fields.end() &&
      openness->second != pane.openness) {
    const TimedWork timed(ui.watch, "ambient occlusion to the graphics card");
    pane.openness = openness->second;
    set_openness(pane.prepared.shown(), *pane.openness);
    pane.surface.set_traits(pane.prepared.shown().traits);
  }
  if (pane.state.error) {
    ui.facts.insert("error");
  }
}

/// Both, as large as the larger one allows.
void PairScreen::look_at(Face face) {
  face_ = face;
  float half_height_mm = 0;
  for (Pane& pane : panes_) {
    if (!pane.surface.empty()) {
      pane.camera.eye_from_model = eye_towards(face, pane.state.tablet_from_model);
      pane.camera.fit(pane.prepared.shown().box_mm, aspect_);
      half_height_mm = std::max(half_height_mm, pane.camera.half_height_mm);
    }
  }
  for (Pane& pane : panes_) {
    pane.camera.half_height_mm = half_height_mm;
  }
  untouched_ = true;
}

/// Turned, moved and brought nearer by as much as the one under the hand was.
void PairScreen::follow(const OrbitCamera& before, const Pane& moved, Pane& other) const {
  const OrbitCamera& now = moved.camera;
  const Eigen::Vector3f shift = now.eye_from_model * (now.centre_mm - before.centre_mm);
  other.camera.half_height_mm *= now.half_height_mm / before.half_height_mm;
  other.camera.eye_from_model =
      (now.eye_from_model * before.eye_from_model.conjugate() * other.camera.eye_from_model).normalized();
  other.camera.centre_mm += other.camera.eye_from_model.conjugate() * shift;
}

void PairScreen::draw(UiContext& ui, ImVec2 size) {
  unfinished_ = false;
  for (Pane& pane : panes_) {
    take_state(ui, pane);
  }
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("pair", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings);
  draw_bar(ui);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const ImVec2 half{0.5F * (room.x - ImGui::GetStyle().ItemSpacing.x), room.y};
  if (aspect_ != half.x / half.y) {
    aspect_ = half.x / half.y;
    if (untouched_) {
      look_at(face_);
    }
  }
  draw_pane(ui, panes_[0], "left-tablet", half);
  ImGui::SameLine();
  draw_pane(ui, panes_[1], "right-tablet", half);
  ImGui::End();
  if (std::ranges::all_of(panes_, [](const Pane& pane) { return pane.surface.whole(); })) {
    ui.facts.insert("whole");
  }
  if (std::ranges::all_of(panes_, [](const Pane& pane) { return pane.state.stage.empty(); })) {
    ui.facts.insert("idle");
  }
}

void PairScreen::draw_bar(UiContext& ui) {
  ImGui::PushFont(ui.fonts.small);
  const ImGuiStyle& style = ImGui::GetStyle();
  const float end = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  // Beside what was drawn last where it fits, else in a row below.
  const auto beside = [&](float wide) {
    if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + wide <= end) {
      ImGui::SameLine();
    }
  };
  const auto tick_beside = [&](const char* name, Text text, bool& value) {
    beside(ImGui::GetFrameHeight() + style.ItemInnerSpacing.x + ImGui::CalcTextSize(ui.text(text)).x);
    tick(ui, name, ui.text(text), value);
  };
  for (int k = 0; k < kFaceCount; ++k) {
    const std::string name = fmt::format("view.{}", to_string(static_cast<Face>(k)));
    const std::string label = fmt::format("{}  {}", k + 1, ui.text(kFaceTexts[k]));
    if (k > 0) {
      beside(ImGui::CalcTextSize(label.c_str()).x + 2 * style.FramePadding.x);
    }
    if (plain_button(ui, name.c_str(), label.c_str()) || ImGui::IsKeyPressed(GLFW_KEY_1 + k, false)) {
      look_at(static_cast<Face>(k));
    }
  }
  tick_beside("together", Text::kTogether, together_);
  if (ImGui::IsKeyPressed(GLFW_KEY_L, false)) {
    together_ = !together_;
  }
  ui.facts.insert(together_ ? "turned-together" : "turned-alone");
  tick_beside("lamp", Text::kLamp, look_.lamp);
  ImGui::PopFont();
}

void PairScreen::draw_pane(UiContext& ui, Pane& pane, const char* name, ImVec2 size) {
  ImGui::BeginChild(name, size, false, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  const ImVec2 end{origin.x + size.x, origin.y + size.y};
  ImGui::InvisibleButton("##surface", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle |
                             ImGuiButtonFlags_MouseButtonRight);
  ui.target(name, Reach::kNone);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(origin, end, packed(ui.colours.text, 0.05F), 6);
  std::string words = pane.state.name;
  if (pane.surface.empty()) {
    words = pane.state.error ? translated(*pane.state.error, ui.preferences.language)
                             : std::string(ui.text(pane.prepared.waiting_text(pane.state)));
  } else {
    const OrbitCamera before = pane.camera;
    if (use_hand(origin, size, pane.camera, look_, pane.dragged)) {
      untouched_ = false;
      if (together_) {
        follow(before, pane, &pane == &panes_[0] ? panes_[1] : panes_[0]);
      }
    }
    look_.red = ui.colours.red.head<3>();
    look_.amber = ui.colours.amber.head<3>();
    Look look = look_;
    if (look.overlay == Overlay::kColours && pane.prepared.shown().colours.empty()) {
      look.overlay = Overlay::kClay;
    }
    {
      const TimedWork timed(ui.watch, "the surface's picture");
      const bool more =
          pane.surface.draw(pane.camera, look, static_cast<int>(size.x), static_cast<int>(size.y));
      unfinished_ = unfinished_ || more;
    }
    draw->AddImage(picture_of(pane.surface.texture()), origin, end, {0, 1}, {1, 0});
    draw_scale_bar(ui, pane.camera, origin, size);
  }
  draw->AddText(nullptr, 0, {origin.x + ui.px(1), origin.y + ui.px(0.6F)},
                packed(pane.surface.empty() && pane.state.error ? ui.colours.bad : ui.colours.text),
                words.c_str(), nullptr, size.x - ui.px(2));
  if (!pane.surface.empty()) {
    const float under_name = ImGui::CalcTextSize(words.c_str(), nullptr, false, size.x - ui.px(2)).y;
    std::vector<Remark> remarks = remarks_on(ui, pane.prepared.shown(), pane.state.error);
    for (const Error& doubt : pane.state.mesh_doubts) {
      ui.facts.insert("mesh-doubt");
      remarks.emplace_back(ui.colours.bad, translated(doubt, ui.preferences.language));
    }
    draw_remarks(ui, remarks, {origin.x + ui.px(1), origin.y + ui.px(0.8F) + under_name}, size.x - ui.px(2));
    if (!remarks.empty()) {
      ui.facts.insert(fmt::format("doubt.{}", name));
    }
  }
  ImGui::EndChild();
}

}  // namespace dubsar::ui
