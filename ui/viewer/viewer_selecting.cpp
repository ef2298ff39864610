// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Selections: drawn by polygons, kept under a name, shown again, written, analysed alone.
#include <algorithm>

#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

/// Kept selections that are listed before the list scrolls.
constexpr int kMostListed = 4;

}  // namespace

MeshSelection ViewerScreen::selection_now() const {
  return {selection_name_, select_of_, ranges_of(selected_)};
}

void ViewerScreen::clear_selected() {
  surface_.clear_selection();
  selected_.clear();
  selected_mm2_ = 0;
}

void ViewerScreen::close_polygon() {
  if (is_current() && surface_.select(select_of_, polygon_, step_, !visible_only_)) {
    std::vector<std::uint32_t> chosen;
    const std::vector<std::uint32_t> selected = surface_.selection()->read();
    for (std::size_t k = 0; k < selected.size(); ++k) {
      if (selected[k] != 0) {
        chosen.push_back(select_of_ == MeshElement::kFace ? prepared_.shown().face_of[k]
                                                          : static_cast<std::uint32_t>(k));
      }
    }
    take_selected(std::move(chosen));
  }
  polygon_.clear();
}

void ViewerScreen::take_selected(std::vector<std::uint32_t> selected) {
  selected_ = std::move(selected);
  std::ranges::sort(selected_);
  selected_mm2_ = 0;
  if (select_of_ == MeshElement::kFace) {
    const auto& p = state_.mesh->positions;
    for (const std::uint32_t f : selected_) {
      const auto& [a, b, c] = state_.mesh->faces[f];
      selected_mm2_ += 0.5 * static_cast<double>((p[b] - p[a]).cross(p[c] - p[a]).norm());
    }
  }
}

void ViewerScreen::show_selection(const MeshSelection& selection) {
  select_of_ = selection.of;
  selection_name_ = selection.name;
  std::vector<std::uint32_t> chosen = indices_of(selection.ranges);
  if (selection.of == MeshElement::kVertex) {
    std::vector<std::uint32_t> marks(prepared_.shown().positions.size(), 0);
    for (const std::uint32_t v : chosen) {
      marks[v] = 1;
    }
    surface_.set_selection(selection.of, marks);
  } else {
    std::vector<std::uint8_t> is_chosen(state_.mesh->faces.size(), 0);
    for (const std::uint32_t f : chosen) {
      is_chosen[f] = 1;
    }
    std::vector<std::uint32_t> marks(prepared_.shown().faces.size());
    std::ranges::transform(prepared_.shown().face_of, marks.begin(),
                           [&](std::uint32_t f) { return is_chosen[f]; });
    surface_.set_selection(selection.of, marks);
    std::erase_if(chosen, [&](std::uint32_t f) {  // what cannot be drawn has no area either
      return std::ranges::any_of(state_.mesh->faces[f],
                                 [&](std::uint32_t v) { return v >= state_.mesh->positions.size(); });
    });
  }
  take_selected(std::move(chosen));
}

void ViewerScreen::draw_selecting(UiContext& ui) {
  coloured_text(ui.colours.faint, ui.text(Text::kSelectHint));
  const auto of = [&](const char* name, Text text, MeshElement which) {
    if (ImGui::RadioButton(ui.text(text), select_of_ == which) && select_of_ != which) {
      clear_selected();
      select_of_ = which;
    }
    ui.target(name);
  };
  if (prepared_.shown().faces.empty()) {
    select_of_ = MeshElement::kVertex;
  } else {
    of("select-faces", Text::kSelectFaces, MeshElement::kFace);
    ImGui::SameLine();
  }
  of("select-points", Text::kSelectPoints, MeshElement::kVertex);
  const auto step = [&](const char* name, Text text, SelectionStep which) {
    if (ImGui::RadioButton(ui.text(text), step_ == which)) {
      step_ = which;
    }
    ui.target(name);
  };
  step("select-union", Text::kUnion, SelectionStep::kUnion);
  ImGui::SameLine();
  step("select-intersect", Text::kIntersect, SelectionStep::kIntersection);
  ImGui::SameLine();
  step("select-subtract", Text::kSubtract, SelectionStep::kDifference);
  tick(ui, "visible-only", ui.text(Text::kVisibleOnly), visible_only_);
  if (!is_current()) {
    return;
  }
  if (!surface_.can_select(select_of_)) {
    const std::string most = filled(ui.text(Text::kTooManyToSelect), grouped(MeshSelecting::most()));
    coloured_text(ui.colours.amber, most.c_str());
    return;
  }
  if (surface_.selection() != nullptr) {
    draw_selected(ui);
  }
  draw_kept_selections(ui);
}

void ViewerScreen::draw_selected(UiContext& ui) {
  ui.facts.insert(selected_.empty() ? "nothing-selected" : "selected");
  ui.facts.insert(fmt::format("selected.{}", selected_.size()));
  const std::string words = select_of_ == MeshElement::kFace
                                ? filled(ui.text(Text::kSelected), grouped(selected_.size()), selected_mm2_)
                                : filled(ui.text(Text::kSelectedPoints), grouped(selected_.size()));
  coloured_text(ui.colours.text, words.c_str());
  ImGui::SameLine();
  if (plain_button(ui, "clear-selection", ui.text(Text::kClear))) {
    clear_selected();
    return;
  }
  const bool idle = state_.stage.empty() && !selected_.empty();
  if (plain_button(ui, "keep-selection", ui.text(Text::kKeepSelection), idle)) {
    viewing_.write_part(selection_now(), unused_file("part", ".ply"));
  }
  if (plain_button(ui, "selected-wedges", ui.text(Text::kWedgesAsTable), idle && state_.wedges)) {
    viewing_.write_wedges_of(selection_now(), unused_file("wedges", ".csv"));
  }
  if (plain_button(ui, "analyse-part", ui.text(Text::kAnalysePart),
                   idle && select_of_ == MeshElement::kFace)) {
    viewing_.analyse_part(selection_now(), unused_file("part", ".ply").replace_extension());
  }
  ImGui::TextUnformatted(ui.text(Text::kSelectionName));
  ImGui::SameLine();
  short_text(ui, "selection-name", selection_name_, ui.px(6));
  ImGui::SameLine();
  if (plain_button(ui, "name-selection", ui.text(Text::kKeep), idle && !selection_name_.empty())) {
    viewing_.keep_selection(selection_now());
  }
}

void ViewerScreen::draw_kept_selections(UiContext& ui) {
  const std::vector<MeshSelection>& kept = *state_.selections;
  if (kept.empty()) {
    return;
  }
  const int lines = std::min(kMostListed, static_cast<int>(kept.size()));
  ImGui::BeginChild(
      "kept", {0, static_cast<float>(lines) * ImGui::GetTextLineHeightWithSpacing() + ui.px(0.8F)}, true);
  bool is_kept = false;
  int row = 0;
  for (const MeshSelection& selection : kept) {
    const bool chosen = selection.name == selection_name_;
    is_kept = is_kept || chosen;
    if (ImGui::Selectable(fmt::format("{}##kept", selection.name).c_str(), chosen)) {
      const TimedWork timed(ui.watch, "a kept selection");
      show_selection(selection);
    }
    ui.target(fmt::format("kept.{}", ++row));
  }
  ImGui::EndChild();
  if (plain_button(ui, "forget-selection", ui.text(Text::kForget), is_kept && state_.stage.empty())) {
    viewing_.forget_selection(selection_name_);
  }
}

}  // namespace dubsar::ui
