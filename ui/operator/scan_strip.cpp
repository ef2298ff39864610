// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The scans that there are, and what can be done with each.
#include <algorithm>

#include "core/scan_remark.h"
#include "ui/operator/operator_screen.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

namespace {

Text state_text(const LiveState& state, const LiveScan& scan) {
  if (scan.damaged) {
    return Text::kDamaged;
  }
  if (scan.dropped) {
    return Text::kDropped;
  }
  if (!scan.pose) {
    return Text::kJudged;
  }
  if (copy_of(state, scan)) {
    return Text::kCopyOf;
  }
  switch (scan.pose->status) {
    case PoseStatus::kRegistered:
      return Text::kRegistered;
    case PoseStatus::kUnsure:
      return Text::kUnsure;
    case PoseStatus::kFailed:
      break;
  }
  return Text::kFailed;
}

Eigen::Vector4f state_colour(const UiContext& ui, Text state) {
  switch (state) {
    case Text::kRegistered:
      return ui.colours.good;
    case Text::kUnsure:
    case Text::kCopyOf:
      return ui.colours.amber;
    case Text::kFailed:
    case Text::kDamaged:
      return ui.colours.bad;
    default:
      return ui.colours.faint;
  }
}

/// It stands, and may have been taken out.
bool is_of_loss(const LiveScan& scan) {
  return scan.record_lost && !scan.dropped && !scan.damaged;
}

std::string words_under(const UiContext& ui, const LiveState& state, const LiveScan& scan) {
  const bool is_warned = !scan_warning(scan, ui.preferences.language).empty();
  const std::optional<int> first = copy_of(state, scan);
  const Text says = is_warned          ? Text::kWarned
                    : is_of_loss(scan) ? Text::kRecordLost
                                       : state_text(state, scan);
  std::string words = fmt::format(
      "{}  {}", scan.id, first ? filled(ui.text(Text::kCopyOf), *first) : std::string(ui.text(says)));
  if (scan.pose && scan.pose->locked) {
    words += fmt::format(", {}", ui.text(Text::kLocked));
  }
  return words;
}

}  // namespace

void OperatorScreen::draw_strip(UiContext& ui, ImVec2 size) {
  ImGui::BeginChild("strip", size, true, ImGuiWindowFlags_HorizontalScrollbar);
  const float height = size.y - 2 * ImGui::GetStyle().WindowPadding.y - ImGui::GetStyle().ScrollbarSize;
  // As wide as its words, however large the letters are.
  const float line = ui.fonts.small->FontSize;
  const auto words_wide = [&](const std::string& words) {
    return ui.fonts.small->CalcTextSizeA(line, 1e4F, 0, words.c_str()).x + 12;
  };
  float width = 1.35F * height;
  for (const LiveScan& scan : state_.scans) {
    width = std::max(width, words_wide(words_under(ui, state_, scan)));
  }
  const LiveScan* menu = nullptr;
  for (const LiveScan& scan : state_.scans) {
    ImGui::PushID(scan.id);
    const ImVec2 origin = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("##scan", {width, height})) {
      chosen_ = scan.id;
      ImGui::OpenPopup("menu");
    }
    ui.target("scan." + std::to_string(scan.id));
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const ImVec2 end{origin.x + width, origin.y + height};
    const Text state = state_text(state_, scan);
    const std::optional<int> first = copy_of(state_, scan);
    ui.facts.insert("scan." + std::to_string(scan.id) + "." +
                    (first ? "copy" : text_of(state, Language::kEnglish)));
    if (state_.pins && state_.pins->tips.contains(scan.id)) {
      ui.facts.insert(fmt::format("scan.{}.pins.{}", scan.id, state_.pins->tips.at(scan.id).size()));
    }
    const bool is_warned = !scan_warning(scan, ui.preferences.language).empty() || is_of_loss(scan);
    const Eigen::Vector4f colour = is_warned ? ui.colours.amber : state_colour(ui, state);
    draw->AddRectFilled(origin, end, packed(ui.colours.text, ImGui::IsItemHovered() ? 0.14F : 0.07F), 5);
    if (scan.picture) {
      Thumbnail& thumbnail = thumbnails_[scan.id];
      if (thumbnail.of != scan.picture || thumbnail.blue != ui.preferences.blue_for_red) {
        const TimedWork timed(ui.watch, "a scan's thumbnail");
        thumbnail.texture.upload(scan.picture->cols, scan.picture->rows, 3,
                                 coloured(*scan.picture, ui).data(), true);
        thumbnail.of = scan.picture;
        thumbnail.blue = ui.preferences.blue_for_red;
      }
      const ImVec2 box{width - 8, height - line - 10};
      const float scale = std::min(box.x / static_cast<float>(scan.picture->cols),
                                   box.y / static_cast<float>(scan.picture->rows));
      const ImVec2 drawn{scale * static_cast<float>(scan.picture->cols),
                         scale * static_cast<float>(scan.picture->rows)};
      const ImVec2 at{origin.x + 0.5F * (width - drawn.x), origin.y + 4 + 0.5F * (box.y - drawn.y)};
      draw->AddImage(picture_of(thumbnail.texture.id()), at, {at.x + drawn.x, at.y + drawn.y}, {0, 0}, {1, 1},
                     ImGui::ColorConvertFloat4ToU32({1, 1, 1, scan.dropped ? 0.3F : 1.0F}));
    }
    draw->AddRect(origin, end, packed(colour), 5, 0,
                  state == Text::kUnsure || state == Text::kFailed || is_warned ? 3.0F : 1.5F);
    if (is_of_loss(scan)) {
      ui.facts.insert(fmt::format("scan.{}.records-lost", scan.id));
    }
    if (scan.pose && scan.pose->locked) {
      ui.facts.insert("scan." + std::to_string(scan.id) + ".locked");
    }
    const std::string words = words_under(ui, state_, scan);
    draw->AddText(ui.fonts.small, line, {origin.x + 6, end.y - line - 3}, packed(colour), words.c_str());
    if (words_wide(words) <= width) {
      ui.facts.insert(fmt::format("scan.{}.words-whole", scan.id));
    }
    if (scan.dropped) {
      draw->AddLine({origin.x + 4, end.y - line - 8}, {end.x - 4, origin.y + 4}, packed(ui.colours.faint), 2);
    }
    // Over its scan, in its own size, within the window: where a thumb rests beside the buttons.
    const bool is_right = origin.x > 0.5F * ImGui::GetIO().DisplaySize.x;
    ImGui::SetNextWindowPos({is_right ? end.x : origin.x, origin.y - 2}, ImGuiCond_Always,
                            {is_right ? 1.0F : 0.0F, 1});
    if (ImGui::BeginPopup("menu")) {
      begin_asking(ui);
      menu = &scan;
      draw_scan_menu(ui, *menu);
      ImGui::EndPopup();
    }
    ImGui::PopID();
    ImGui::SameLine();
  }
  if (state_.scans.empty()) {
    coloured_text(ui.colours.faint, ui.text(Text::kScans));
  }
  // There is nothing above or below: the wheel goes along the scans.
  if (const float turned = ImGui::GetIO().MouseWheel; turned != 0 && ImGui::IsWindowHovered()) {
    ImGui::SetScrollX(std::clamp(ImGui::GetScrollX() - turned * width, 0.0F, ImGui::GetScrollMaxX()));
  }
  if (ImGui::GetScrollMaxX() > 0) {
    ui.facts.insert(ImGui::GetScrollX() > 0 ? "strip-scrolled" : "strip-at-first");
  }
  if (strip_scans_ != state_.scans.size()) {
    strip_scans_ = state_.scans.size();
    ImGui::SetScrollHereX(1.0F);
  }
  ImGui::EndChild();
}

void OperatorScreen::draw_scan_menu(UiContext& ui, const LiveScan& scan) {
  ImGui::TextUnformatted(fmt::format("{}  {}", scan.id, scan.file).c_str());
  ImGui::PushFont(ui.fonts.small);
  coloured_text(ui.colours.faint, filled(ui.text(Text::kSamples), scan.samples).c_str());
  if (const std::string place = place_words(scan, ui.preferences.language); !place.empty()) {
    coloured_text(ui.colours.faint, place.c_str());
  }
  if (state_.pins && state_.pins->tips.contains(scan.id)) {
    const std::size_t labelled = state_.pins->tips.at(scan.id).size();
    coloured_text(ui.colours.faint, filled(ui.text(Text::kPinsLabelled), labelled).c_str());
  }
  if (!scan.remark.empty()) {
    ImGui::PushTextWrapPos(ui.px(22));
    coloured_text(ui.colours.amber, translated(scan.remark, ui.preferences.language).c_str());
    ImGui::PopTextWrapPos();
  }
  if (scan.damaged) {
    ImGui::PushTextWrapPos(ui.px(22));
    if (!scan.fault.empty()) {
      coloured_text(ui.colours.bad, (translated(scan.fault, ui.preferences.language) + ".").c_str());
    }
    ImGui::TextUnformatted(ui.text(Text::kDamagedHow));
    ImGui::PopTextWrapPos();
  }
  if (const std::optional<int> first = copy_of(state_, scan)) {
    ImGui::PushTextWrapPos(ui.px(22));
    coloured_text(ui.colours.amber, filled(ui.text(Text::kCountsAs), *first).c_str());
    ImGui::PopTextWrapPos();
  }
  const std::string why = scan.dropped ? translated(scan.note, ui.preferences.language)
                          : scan.pose  ? translated(remark_of(*scan.pose), ui.preferences.language)
                                       : std::string();
  if (!why.empty()) {
    ImGui::PushTextWrapPos(ui.px(22));
    ImGui::TextUnformatted(why.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::PopFont();
  const ImVec2 wide{std::max(ui.px(14), ImGui::GetContentRegionAvail().x), ui.px(2.1F)};
  const auto offer = [&](const char* name, Text text, auto act) {
    if (big_button(ui, name, ui.text(text), nullptr, wide)) {
      act();
      ImGui::CloseCurrentPopup();
    }
  };
  if (session_.device().empty() || scan.damaged) {
    return;
  }
  if (scan.dropped) {
    offer("restore", Text::kRestore, [&] { session_.ask(RestoreScan{scan.id}); });
    return;
  }
  const bool fits = scan.pose && scan.pose->status == PoseStatus::kRegistered;
  if (scan.pose && !fits) {
    offer("pairs", Text::kPointPairs, [&] { pairs_.open(scan, state_.scans); });
  }
  if (scan.hinted) {
    offer("withdraw", Text::kWithdraw, [&] { session_.ask(WithdrawHint{scan.id}); });
  }
  if (scan.measured) {
    offer("label-pins", Text::kLabelPins, [&] { pins_.open(scan, state_); });
  }
  offer("drop", Text::kDrop, [&] { session_.ask(DropScan{scan.id, "taken out by the operator"}); });
  offer("rescan", Text::kRescan, [&] { session_.ask(ScanAgain{scan.id}); });
  const bool is_locked = scan.pose && scan.pose->locked;
  if (fits && !is_locked) {
    offer("lock", Text::kLock, [&] { session_.ask(LockScan{scan.id}); });
  } else if (is_locked) {  // also where its place cannot be held
    offer("unlock", Text::kUnlock, [&] { session_.ask(UnlockScan{scan.id}); });
  }
}

}  // namespace dubsar::ui
