// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/pin_dialog.h"

#include <algorithm>

#include "ui/operator/grid_places.h"
#include "ui/operator/operator_screen.h"
#include "ui/shell/typed_number.h"

namespace dubsar::ui {

namespace {

constexpr const char* kPopup = "###pins";
constexpr double kUsualTipMm = 1.0;

/// 0 when the text is no length.
double diameter_of(const std::string& text) {
  return std::max(0.0, typed_number(text).value_or(0));
}

/// From what of a ball is seen to its centre, or back: pins stand between the scanner and their centres.
Eigen::Vector3d behind(const RangeGrid& grid, const Eigen::Vector3d& point_mm, double by_mm) {
  return point_mm - by_mm * grid.view.to_camera(point_mm, 0.5 * grid.rows);
}

/// Pixels a sample in a picture that fills such a room.
float scale_in(const RangeGrid& grid, ImVec2 room) {
  return std::min(room.x / static_cast<float>(std::max(1, grid.cols)),
                  room.y / static_cast<float>(std::max(1, grid.rows)));
}

}  // namespace

void PinDialog::take(Side& side, const LiveScan& scan) {
  side.scan = scan;
  side.picture = picture_of(*scan.measured, {});
  side.marks.clear();
  side.changed = side.drawn = false;
  const auto known = pins_ ? pins_->tips.find(scan.id) : std::map<int, std::vector<PinTip>>::const_iterator();
  if (!pins_ || known == pins_->tips.end()) {
    return;
  }
  for (const PinTip& tip : known->second) {
    const Eigen::Vector3d seen = is_rim_label(tip.label)
                                     ? tip.position_mm
                                     : behind(*scan.measured, tip.position_mm, -0.5 * pins_->tip_diameter_mm);
    const auto place = place_of(*scan.measured, seen);
    if (tip.label >= 0 && place) {
      side.marks[tip.label] = {*place, seen};
    }
  }
}

void PinDialog::open(const LiveScan& scan, const LiveState& state) {
  if (!scan.measured) {
    return;
  }
  pins_ = state.pins;
  double diameter_mm = scan.measured->pin_tip_diameter_mm;
  diameter_mm = pins_ ? pins_->tip_diameter_mm : diameter_mm > 0 ? diameter_mm : kUsualTipMm;
  diameter_ = fmt::format("{:g}", diameter_mm);
  others_.clear();
  for (const LiveScan& other : state.scans) {
    if (other.id != scan.id && !other.dropped && other.measured) {
      others_.push_back(other);
    }
  }
  take(left_, scan);
  right_.scan = {};
  right_.marks.clear();
  if (!others_.empty()) {
    // The one that tells most: with labels, or else the newest that fits.
    const auto worth = [&](const LiveScan& other) {
      const bool labelled = pins_ && pins_->tips.contains(other.id);
      const bool fits = other.pose && other.pose->status == PoseStatus::kRegistered;
      return 2 * static_cast<int>(labelled) + static_cast<int>(fits);
    };
    take(right_, *std::ranges::max_element(others_.rbegin(), others_.rend(), {}, worth));
  }
  label_ = 1;
  opening_ = true;
}

void PinDialog::draw_labels(UiContext& ui) {
  // In one row where a glove still finds them: a second one would take its height from the pictures.
  const float wide = ImGui::GetContentRegionAvail().x;
  const float gaps = ui.px(0.8F) + ui.px(0.15F) * (kPinNumbers + kRimPlaces - 2);
  const float side = std::clamp((wide - gaps) / (kPinNumbers + kRimPlaces) - 0.5F, ui.px(1.6F), ui.px(1.9F));
  const float row_end = ImGui::GetCursorScreenPos().x + wide;
  for (int k = 0; k < kPinNumbers + kRimPlaces; ++k) {
    const int label = k < kPinNumbers ? k + 1 : kFirstRimLabel + k - kPinNumbers;
    const bool in_left = left_.marks.contains(label);
    const bool in_right = right_.marks.contains(label);
    if (k > 0) {
      const float gap = k == kPinNumbers ? ui.px(0.8F) : ui.px(0.15F);
      if (ImGui::GetItemRectMax().x + gap + side <= row_end) {
        ImGui::SameLine(0, gap);
      }
    }
    const std::string name = pin_name(label);
    if (big_button(ui, ("label." + name).c_str(), name.c_str(), nullptr, {side, side},
                   label == label_ ? ButtonKind::kMain : ButtonKind::kPlain)) {
      label_ = label;
    }
    // Half a line under it for each picture in which it is placed.
    const ImVec2 low = ImGui::GetItemRectMin();
    const ImVec2 high = ImGui::GetItemRectMax();
    const float middle = 0.5F * (low.x + high.x);
    ImDrawList* draw = ImGui::GetWindowDrawList();
    if (in_left) {
      draw->AddLine({low.x + 2, high.y - 2}, {middle - 1, high.y - 2}, packed(ui.colours.good), 3);
    }
    if (in_right) {
      draw->AddLine({middle + 1, high.y - 2}, {high.x - 2, high.y - 2}, packed(ui.colours.good), 3);
    }
  }
}

void PinDialog::draw_side(UiContext& ui, const char* name, Side& side, ImVec2 size) {
  const RangeGrid& grid = *side.scan.measured;
  if (!side.drawn) {
    side.texture.upload(side.picture.cols, side.picture.rows, 3, coloured(side.picture, ui).data(), true);
    side.drawn = true;
  }
  const ClickablePicture picture =
      draw_clickable(ui, name, grid, side.texture,
                     side.marks.contains(label_) ? ui.colours.faint : ui.colours.ghost, 2, size);
  if (picture.clicked) {
    const ImVec2 place = *picture.clicked;
    if (const auto point = sample_at(grid, place.x, place.y)) {
      side.marks[label_] = {place, *point};
      side.changed = true;
      // On with the next once both pictures have it.
      const bool both =
          left_.marks.contains(label_) && (!right_.scan.measured || right_.marks.contains(label_));
      const bool last = label_ == kPinNumbers || label_ == kFirstRimLabel + kRimPlaces - 1;
      label_ += both && !last ? 1 : 0;
    }
  }
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (const auto& [label, mark] : side.marks) {
    const ImVec2 at = picture.at(mark.place);
    const ImU32 ink = packed(label == label_ ? ui.colours.amber : ui.colours.ghost);
    draw->AddCircle(at, ui.px(0.45F), packed({0, 0, 0, 1}), 0, 4);
    draw->AddCircle(at, ui.px(0.45F), ink, 0, 2);
    const ImVec2 text{at.x + ui.px(0.6F), at.y - ui.px(0.6F)};
    draw->AddText({text.x + 1, text.y + 1}, packed({0, 0, 0, 1}), pin_name(label).c_str());
    draw->AddText(text, ink, pin_name(label).c_str());
  }
}

void PinDialog::draw_panes(UiContext& ui, float foot_px) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const bool two = right_.scan.measured != nullptr;
  const ImVec2 half{two ? 0.5F * room.x - ui.px(0.3F) : room.x, room.y - foot_px};
  std::vector<int> ids;
  for (const LiveScan& other : others_) {
    ids.push_back(other.id);
  }
  const ImVec2 padding = ImGui::GetStyle().WindowPadding;
  const ImVec2 picture{half.x - 2 * padding.x - 2,
                       half.y - 2 * padding.y - ImGui::GetTextLineHeightWithSpacing() - 2};
  ImGui::BeginChild("left", half, true);
  ImGui::TextUnformatted(fmt::format("{} {}", ui.text(Text::kScanGrowing), left_.scan.id).c_str());
  draw_side(ui, "pins-left", left_, picture);
  ImGui::EndChild();
  if (!two) {
    return;
  }
  // The scans to choose from stand where the picture is larger: above it, or beside it.
  const ImVec2 above{picture.x, picture.y - rows_of(ids, picture.x) * ImGui::GetFrameHeightWithSpacing()};
  const ImVec2 beside{picture.x - ui.px(5), picture.y};
  const bool is_beside = scale_in(*right_.scan.measured, beside) > scale_in(*right_.scan.measured, above);
  // What was clicked in it would be lost with it: first it is used or cleared.
  int chosen = right_.scan.id;
  const auto choose = [&] {
    ImGui::BeginDisabled(right_.changed);
    if (one_of(ui, "pins-with", ids, chosen)) {
      take(right_, *std::ranges::find(others_, chosen, &LiveScan::id));
    }
    ImGui::EndDisabled();
  };
  ImGui::SameLine();
  ImGui::BeginChild("right", half, true);
  ImGui::TextUnformatted(fmt::format("{} {}", ui.text(Text::kScanGrowing), right_.scan.id).c_str());
  if (!is_beside) {
    choose();
  }
  draw_side(ui, "pins-right", right_, is_beside ? beside : above);
  if (is_beside) {
    ImGui::SameLine(beside.x + padding.x + ImGui::GetStyle().ItemSpacing.x);
    ImGui::BeginChild("choices", {0, picture.y});
    choose();
    ImGui::EndChild();
  }
  ImGui::EndChild();
}

std::vector<LabelPins> PinDialog::said(double diameter_mm) const {
  std::vector<LabelPins> out;
  for (const Side* side : {&left_, &right_}) {
    if (!side->changed) {
      continue;
    }
    LabelPins command{side->scan.id, {}, diameter_mm};
    for (const auto& [label, mark] : side->marks) {
      const double to_centre_mm = is_rim_label(label) ? 0 : 0.5 * diameter_mm;
      command.tips.push_back({label, behind(*side->scan.measured, mark.surface_mm, to_centre_mm)});
    }
    out.push_back(std::move(command));
  }
  return out;
}

std::vector<LabelPins> PinDialog::draw(UiContext& ui) {
  if (!left_.scan.measured) {
    return {};
  }
  if (!begin_wide_box(ui, ui.text(Text::kLabelPins), kPopup, opening_, {0.96F, 0.94F})) {
    left_.scan = right_.scan = {};
    return {};
  }
  ImGui::PushFont(ui.fonts.small);
  ImGui::TextWrapped("%s", ui.text(Text::kLabelPinsHow));
  ImGui::PopFont();
  draw_labels(ui);
  draw_panes(ui, ImGui::GetFrameHeightWithSpacing() + ui.px(0.5F));
  const double diameter_mm = diameter_of(diameter_);
  std::vector<LabelPins> out;
  if (confirmed(ui, "pins-done", Text::kUseLabels, diameter_mm > 0 && (left_.changed || right_.changed))) {
    out = said(diameter_mm);
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (plain_button(ui, "pins-clear", ui.text(Text::kPairsClear))) {
    for (Side* side : {&left_, &right_}) {
      side->changed = side->changed || !side->marks.empty();
      side->marks.clear();
    }
    label_ = 1;
  }
  ImGui::SameLine();
  if (plain_button(ui, "pins-close", ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine(0, ui.px(2));
  ImGui::TextUnformatted(ui.text(Text::kTipDiameter));
  ImGui::SameLine();
  short_text(ui, "tip-diameter", diameter_, ui.px(4));
  ImGui::EndPopup();
  if (!out.empty()) {
    left_.scan = right_.scan = {};
  }
  return out;
}

}  // namespace dubsar::ui
