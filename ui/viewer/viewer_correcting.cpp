// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Corrections of the wedges: deleted, merged, split, added, and taken back.
#include <algorithm>

#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

void ViewerScreen::mark(int wedge) {
  if (wedge < 0) {
    marked_.clear();
    return;
  }
  if (std::erase(marked_, wedge) == 0) {
    marked_.push_back(wedge);
  }
}

std::vector<Eigen::Vector3d> ViewerScreen::marked_places() const {
  std::vector<Eigen::Vector3d> places;
  for (const int k : marked_) {
    places.push_back((*state_.wedges)[static_cast<std::size_t>(k)].depth_point_mm);
  }
  return places;
}

void ViewerScreen::draw_correcting(UiContext& ui) {
  coloured_text(ui.colours.faint, ui.text(splitting_ ? Text::kSplitHint : Text::kCorrectHint));
  std::string ids;
  for (const int k : marked_) {
    ids += (ids.empty() ? "" : ", ") + std::to_string((*state_.wedges)[static_cast<std::size_t>(k)].id);
  }
  ui.facts.insert(fmt::format("marked.{}", marked_.size()));
  if (!marked_.empty()) {
    coloured_text(ui.colours.text, filled(ui.text(Text::kMarkedWedges), marked_.size(), ids).c_str());
  }
  const bool idle = state_.stage.empty() && is_current();
  if (plain_button(ui, "wedge-delete", ui.text(Text::kNoWedge), idle && !marked_.empty() && !splitting_)) {
    viewing_.correct({CorrectionKind::kDelete, marked_places(), {}, {}, 0});
  }
  ImGui::SameLine();
  if (plain_button(ui, "wedge-merge", ui.text(Text::kOneWedge), idle && marked_.size() > 1 && !splitting_)) {
    viewing_.correct({CorrectionKind::kMerge, marked_places(), {}, {}, 0});
  }
  ImGui::BeginDisabled(!idle || marked_.size() != 1);
  if (tick(ui, "wedge-several", ui.text(Text::kSeveralWedges), splitting_)) {
    split_places_.clear();
  }
  ImGui::EndDisabled();
  if (splitting_) {
    ImGui::SameLine();
    if (plain_button(ui, "wedge-split", ui.text(Text::kSplitHere), idle && split_places_.size() > 1)) {
      std::vector<Eigen::Vector3d> into;
      for (const Eigen::Vector3f& place : split_places_) {
        into.push_back(place.cast<double>());
      }
      viewing_.correct({CorrectionKind::kSplit, marked_places(), std::move(into), {}, 0});
    }
  }
  if (plain_button(ui, "wedge-add", ui.text(Text::kWedgeIsSelected),
                   idle && !selects() && !selected_.empty())) {
    viewing_.correct_by_adding(selection_now());
  }
  if (plain_button(ui, "wedge-undo", ui.text(Text::kTakeBack), idle && state_.corrections > 0)) {
    viewing_.undo_correction();
  }
  ui.facts.insert(fmt::format("corrections.{}", state_.corrections));
  if (state_.corrections > 0) {
    ImGui::SameLine();
    coloured_text(ui.colours.text, filled(ui.text(Text::kCorrections), state_.corrections).c_str());
  }
  for (const std::string& why : state_.not_made) {
    ui.facts.insert("not-made");
    ImGui::PushTextWrapPos();
    coloured_text(ui.colours.bad,
                  filled(ui.text(Text::kNotMade), translated(why, ui.preferences.language)).c_str());
    ImGui::PopTextWrapPos();
  }
}

void ViewerScreen::draw_split_places(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  if (!splitting_) {
    return;
  }
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (const Eigen::Vector3f& place : split_places_) {
    const Eigen::Vector2f px = camera_.pixel_of(place, {size.x, size.y});
    draw->AddCircleFilled({origin.x + px.x(), origin.y + px.y()}, ui.px(0.3F), packed(ui.colours.ghost));
  }
}

}  // namespace dubsar::ui
