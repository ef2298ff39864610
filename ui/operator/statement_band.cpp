// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What to do next, and the main actions beside it.
#include <algorithm>

#include "ui/operator/operator_screen.h"
#include "ui/operator/statement_words.h"

namespace dubsar::ui {

namespace {

Eigen::Vector4f tone_colour(const UiContext& ui, Tone tone) {
  switch (tone) {
    case Tone::kHandsOff:
    case Tone::kWarn:
      return ui.colours.amber;
    case Tone::kAsk:
      return ui.colours.ghost;
    case Tone::kGood:
      return ui.colours.good;
    case Tone::kBad:
      return ui.colours.bad;
    case Tone::kPlain:
      break;
  }
  return ui.colours.faint;
}

/// Where everything stands in the band. Buttons are as wide as a glove wants, but leave the words two fifths.
struct Band {
  ImVec2 words_at;  ///< from the band's corner
  float words_wide;
  float above_and_below;  ///< of the words
  float button_wide;
  float half_button_wide;
  float buttons_wide;
};

Band band_of(const UiContext& ui, float wide) {
  Band band{};
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  band.words_at = {ui.px(1.1F), ui.px(0.5F)};
  band.above_and_below = 2 * ui.px(0.5F);
  band.button_wide = std::min(ui.px(7.6F), 0.145F * wide);
  band.half_button_wide = std::min(ui.px(6), 0.115F * wide);
  band.buttons_wide = 3 * (band.button_wide + gap) + band.half_button_wide + ui.px(0.4F);
  band.words_wide = wide - band.buttons_wide - ui.px(1.6F);
  return band;
}

constexpr float kUsualFonts = 5.6F;  ///< high
constexpr float kMostOfWindow = 0.45F;

StatementWords words_in(const UiContext& ui, const Statement& statement, const Band& band, float room_high) {
  return set_words(statement, ui.fonts, band.words_wide, ui.px(kUsualFonts) - band.above_and_below,
                   kMostOfWindow * room_high - band.above_and_below);
}

}  // namespace

/// As much as its words take: nothing of them may be hidden.
float OperatorScreen::statement_high_px(const UiContext& ui, const Statement& statement, ImVec2 room) {
  const Band band = band_of(ui, room.x);
  return std::max(ui.px(kUsualFonts), words_in(ui, statement, band, room.y).high_px + band.above_and_below);
}

void OperatorScreen::draw_statement(UiContext& ui, const Statement& statement, ImVec2 size) {
  const float room_high = ImGui::GetContentRegionAvail().y;
  ImGui::BeginChild("statement", size, false,
                    ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 origin = ImGui::GetWindowPos();
  const Eigen::Vector4f tone = tone_colour(ui, statement.tone);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(origin, {origin.x + size.x, origin.y + size.y}, packed(tone, 0.16F), 6);
  draw->AddRectFilled(origin, {origin.x + ui.px(0.5F), origin.y + size.y}, packed(tone), 3);
  const Band band = band_of(ui, size.x);
  const StatementWords words = words_in(ui, statement, band, room_high);
  const ImVec2 at{origin.x + band.words_at.x, origin.y + band.words_at.y};
  const ImU32 ink = packed(ui.colours.text);
  draw->AddText(ui.fonts.large, words.headline_px, at, ink, statement.headline.c_str(), nullptr,
                band.words_wide);
  draw->AddText(words.detail_px < ui.fonts.normal->FontSize ? ui.fonts.small : ui.fonts.normal,
                words.detail_px, {at.x, at.y + words.detail_at_px}, ink, statement.detail.c_str(), nullptr,
                band.words_wide);
  if (words.high_px + band.above_and_below <= size.y + 0.5F) {
    ui.facts.insert("statement-whole");
  }
  const ImVec2 button{band.button_wide, size.y - ui.px(0.8F)};
  ImGui::SetCursorPos({size.x - band.buttons_wide, ui.px(0.4F)});
  if (big_button(
          ui, "scan", ui.text(statement.scan_label), ui.text(Text::kKeyScan), button,
          statement.tone == Tone::kGood && state_.package.empty() ? ButtonKind::kPlain : ButtonKind::kMain,
          statement.may_scan || statement.may_next)) {
    if (statement.may_next) {
      open_next();
    } else {
      session_.scan_now();
    }
  }
  ImGui::SameLine();
  if (big_button(ui, "undo", ui.text(Text::kUndo), ui.text(Text::kKeyUndo), button, ButtonKind::kPlain,
                 statement.may_undo)) {
    undo();
  }
  ImGui::SameLine();
  draw_last_action(ui, statement, button);
  ImGui::SameLine();
  ImGui::BeginGroup();
  const ImVec2 half{band.half_button_wide, 0.5F * (button.y - ImGui::GetStyle().ItemSpacing.y)};
  if (big_button(ui, "stop", ui.text(Text::kStop), nullptr, half, ButtonKind::kPlain, statement.may_stop)) {
    session_.stop();
  }
  if (big_button(ui, "viewer", ui.text(Text::kView), nullptr, half, ButtonKind::kPlain,
                 state_.mesh != nullptr)) {
    wants_viewer_ = true;
  }
  ImGui::EndGroup();
  ImGui::EndChild();
}

/// No more scans, then the signature, then the package.
void OperatorScreen::draw_last_action(UiContext& ui, const Statement& statement, ImVec2 button) {
  if (statement.may_pack) {
    if (big_button(ui, "package", ui.text(Text::kPackage), ui.text(Text::kKeySign), button,
                   state_.package.empty() ? ButtonKind::kMain : ButtonKind::kPlain)) {
      open_package();
    }
    return;
  }
  const bool finish = statement.may_finish;
  if (big_button(ui, finish ? "finish" : "sign", ui.text(finish ? Text::kFinish : Text::kSign),
                 ui.text(Text::kKeySign), button, statement.may_sign ? ButtonKind::kMain : ButtonKind::kPlain,
                 statement.may_sign || finish)) {
    if (finish) {
      session_.finish();
    } else {
      open_signing(ui);
    }
  }
}

}  // namespace dubsar::ui
