// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/pair_dialog.h"

#include <algorithm>

#include "ui/operator/grid_places.h"
#include "ui/operator/operator_screen.h"

namespace dubsar::ui {

namespace {

constexpr const char* kPopup = "###pairs";

}  // namespace

void PairDialog::open(const LiveScan& unsure, const std::vector<LiveScan>& scans) {
  others_.clear();
  for (const LiveScan& scan : scans) {
    if (scan.id != unsure.id && !scan.dropped && scan.grid && scan.pose &&
        scan.pose->status == PoseStatus::kRegistered) {
      others_.push_back(scan);
    }
  }
  if (!unsure.grid || others_.empty()) {
    return;
  }
  unsure_ = unsure;
  choose(others_.size() - 1);
  opening_ = true;
}

void PairDialog::choose(std::size_t other) {
  other_ = other;
  left_.points_mm.clear();
  left_.places.clear();
  right_.points_mm.clear();
  right_.places.clear();
  textures_old_ = true;
}

void PairDialog::draw_side(UiContext& ui, const char* name, const LiveScan& scan, Side& side, bool expects,
                           ImVec2 size) {
  const RangeGrid& grid = *scan.grid;
  const ClickablePicture picture =
      draw_clickable(ui, name, grid, side.texture, expects ? ui.colours.ghost : ui.colours.faint,
                     expects ? 3.0F : 1.0F, size);
  if (expects && picture.clicked) {
    const ImVec2 place = *picture.clicked;
    if (const auto point = sample_at(grid, place.x, place.y)) {
      side.points_mm.push_back(*point);
      side.places.push_back(place);
    }
  }
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (std::size_t k = 0; k < side.places.size(); ++k) {
    const ImVec2 at = picture.at(side.places[k]);
    const std::string number = std::to_string(k + 1);
    const ImVec2 text{at.x + ui.px(0.5F), at.y - ui.px(0.6F)};
    draw->AddCircleFilled(at, ui.px(0.45F), packed({0, 0, 0, 1}));
    draw->AddCircleFilled(at, ui.px(0.35F), packed(ui.colours.ghost));
    draw->AddRectFilled({text.x - 2, text.y},
                        {text.x + ImGui::CalcTextSize(number.c_str()).x + 2, text.y + ui.px(1)},
                        packed(ui.colours.panel, 0.85F), 3);
    draw->AddText(text, packed(ui.colours.ghost), number.c_str());
  }
}

std::optional<HintScan> PairDialog::draw(UiContext& ui) {
  std::optional<HintScan> out;
  if (!is_open()) {
    return out;
  }
  if (!begin_wide_box(ui, ui.text(Text::kPointPairs), kPopup, opening_)) {
    unsure_ = {};
    return out;
  }
  const LiveScan& other = others_[other_];
  if (textures_old_) {
    const auto upload = [&](PixelTexture& texture, const LiveScan& scan) {
      texture.upload(scan.picture->cols, scan.picture->rows, 3, coloured(*scan.picture, ui).data(), true);
    };
    upload(left_.texture, unsure_);
    upload(right_.texture, other);
    textures_old_ = false;
  }
  ImGui::TextWrapped("%s", ui.text(Text::kClickSamePlace));
  const float foot = ImGui::GetFrameHeightWithSpacing() + ui.px(0.5F);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const ImVec2 half{0.5F * room.x - ui.px(0.5F), room.y - foot};
  std::vector<int> ids;
  for (const LiveScan& one : others_) {
    ids.push_back(one.id);
  }
  const float choices = rows_of(ids, half.x - ui.px(1.2F)) * ImGui::GetFrameHeightWithSpacing();
  const ImVec2 picture{half.x - ui.px(1.2F), half.y - choices - 1.4F * ImGui::GetFrameHeightWithSpacing()};
  const bool expects_left = left_.places.size() <= right_.places.size();
  ImGui::BeginChild("left", half, true);
  const bool failed = unsure_.pose->status == PoseStatus::kFailed;
  ImGui::TextUnformatted(
      filled(ui.text(Text::kScanIs), unsure_.id, ui.text(failed ? Text::kFailed : Text::kUnsure)).c_str());
  ImGui::Dummy({1, choices - ImGui::GetStyle().ItemSpacing.y});
  draw_side(ui, "pair-left", unsure_, left_, expects_left, picture);
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("right", half, true);
  ImGui::TextUnformatted(filled(ui.text(Text::kScanIs), other.id, ui.text(Text::kRegistered)).c_str());
  int chosen = other.id;
  if (one_of(ui, "pair-with", ids, chosen)) {
    choose(static_cast<std::size_t>(std::ranges::find(ids, chosen) - ids.begin()));
  }
  draw_side(ui, "pair-right", others_[other_], right_, !expects_left, picture);
  ImGui::EndChild();
  const std::size_t pairs = std::min(left_.points_mm.size(), right_.points_mm.size());
  if (confirmed(ui, "pairs-done", Text::kPairsDone, pairs > 0)) {
    HintScan hint;
    hint.id = unsure_.id;
    hint.given.hint.on = others_[other_].id;
    for (std::size_t k = 0; k < pairs; ++k) {
      hint.given.hint.points.push_back({left_.points_mm[k], right_.points_mm[k]});
    }
    out = std::move(hint);
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  // One click that went astray does not cost the others.
  if (plain_button(ui, "pairs-back", ui.text(Text::kTakeBack), !left_.places.empty())) {
    Side& last = left_.places.size() > right_.places.size() ? left_ : right_;
    last.places.pop_back();
    last.points_mm.pop_back();
  }
  ImGui::SameLine();
  if (plain_button(ui, "pairs-clear", ui.text(Text::kPairsClear))) {
    choose(other_);
  }
  ImGui::SameLine();
  if (plain_button(ui, "pairs-close", ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  ImGui::TextUnformatted(filled(ui.text(Text::kPairCount), pairs).c_str());
  ImGui::EndPopup();
  if (out) {
    unsure_ = {};
  }
  return out;
}

}  // namespace dubsar::ui
