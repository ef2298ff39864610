// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The profile of a cut through the surface, drawn over it and as a plot with its measures.
#include <algorithm>
#include <array>
#include <cmath>

#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

/// How much higher than long the plot draws: a round number, so that it can be said.
double exaggeration(double fits) {
  constexpr std::array kRound{1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0};
  double out = 1;
  for (const double round : kRound) {
    out = round <= fits ? round : out;
  }
  return out;
}

}  // namespace

void ViewerScreen::cut_between_places() {
  const Eigen::Vector3f towards = camera_.eye_from_model.conjugate() * Eigen::Vector3f::UnitZ();
  viewing_.cut(tape_[0].cast<double>(), tape_[1].cast<double>(), towards.cast<double>());
  state_.section.reset();  // of other places; the rest of this frame is drawn without it
  state_.section_due = true;
}

void ViewerScreen::draw_section_panel(UiContext& ui) {
  coloured_text(ui.colours.faint, ui.text(Text::kSectionHint));
  if (tape_.size() != 2) {
    return;
  }
  if (state_.section_due) {
    ui.facts.insert("section-due");
    coloured_text(ui.colours.faint, "...");
    return;
  }
  if (!state_.section) {  // it was stopped while it waited, or cannot be made, which the foot says
    tape_.clear();
    return;
  }
  const CrossSection& section = *state_.section;
  ui.facts.insert("section");
  coloured_text(
      ui.colours.text,
      filled(ui.text(Text::kSectionLine), section.length_mm, std::max(0.0, -section.lowest_mm)).c_str());
  if (plain_button(ui, "keep-section", ui.text(Text::kKeepSection),
                   !section.lines.empty() && state_.stage.empty())) {
    section_file_ = unused_file("section", {".csv", ".svg"});
    viewing_.keep_section(std::filesystem::path(section_file_).replace_extension());
  }
  if (!state_.written.empty() && state_.written.front() == section_file_) {
    ui.facts.insert("section-kept");
  }
}

void ViewerScreen::draw_section(UiContext& ui, ImVec2 origin, ImVec2 size) const {
  if (tool_ != Tool::kSection || tape_.size() != 2 || !state_.section || state_.section->lines.empty()) {
    return;
  }
  const CrossSection& section = *state_.section;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 ink = packed(ui.colours.ghost);
  float cut_top = origin.y + size.y;
  float cut_bottom = origin.y;
  for (const auto& line : section.lines) {
    std::vector<ImVec2> over;
    over.reserve(line.size());
    for (const CrossSection::Point& p : line) {
      const Eigen::Vector2f px = camera_.pixel_of(p.place_mm.cast<float>(), {size.x, size.y});
      over.emplace_back(origin.x + px.x(), origin.y + px.y());
      cut_top = std::min(cut_top, over.back().y);
      cut_bottom = std::max(cut_bottom, over.back().y);
    }
    draw->AddPolyline(over.data(), static_cast<int>(over.size()), ink, 0, 2.5F);
  }
  // The plot stands above the scale bar, or at the top where it would hide the very cut.
  const float plot_high = ui.px(9);
  const float top = origin.y + ui.px(1);
  const float bottom = origin.y + size.y - ui.px(2);
  const bool at_top = cut_bottom > bottom - plot_high && cut_top > top + plot_high;
  const ImVec2 low{origin.x + ui.px(1), at_top ? top : bottom - plot_high};
  const ImVec2 high{origin.x + size.x - ui.px(1), low.y + plot_high};
  const float small = ui.fonts.small->FontSize;
  const float words_wide = high.x - low.x - ui.px(1.2F);
  draw->AddRectFilled(low, high, packed(ui.colours.panel, 0.9F), 5);
  draw->AddRect(low, high, packed(ui.colours.faint, 0.6F), 5);
  const double room_x = static_cast<double>(high.x - low.x) - 2.0 * static_cast<double>(ui.px(1.5F));
  const double top_mm = std::max(0.0, section.highest_mm);
  const double bottom_mm = std::min(0.0, section.lowest_mm);
  // Large letters take a second line for what is said of the heights.
  const std::string length = fmt::format("{} mm", decimal(section.length_mm, 3, ui.preferences.language));
  const auto said_of = [&](double times) {
    return times > 1 ? length + "   " + filled(ui.text(Text::kSectionTimes), times) : length;
  };
  const float words_high = ui.fonts.small->CalcTextSizeA(small, 1e6F, words_wide, said_of(10).c_str()).y;
  const float head = ui.px(1) + words_high;
  const double room_y = static_cast<double>(high.y - low.y - head - ui.px(1.6F));
  const double relief_mm = std::max(top_mm - bottom_mm, 1e-3);
  double px_per_mm = room_x / (section.last_along_mm - section.first_along_mm);
  const double times = exaggeration(room_y / (relief_mm * px_per_mm));
  px_per_mm = std::min(px_per_mm, room_y / (relief_mm * times));
  const auto at = [&](double along, double height) {
    return ImVec2(low.x + ui.px(1.5F) + static_cast<float>((along - section.first_along_mm) * px_per_mm),
                  low.y + head + static_cast<float>((top_mm - height) * times * px_per_mm));
  };
  const ImU32 faint = packed(ui.colours.faint);
  draw->AddLine(at(0, 0), at(section.length_mm, 0), faint, 1);
  for (const auto& line : section.lines) {
    std::vector<ImVec2> plot;
    plot.reserve(line.size());
    for (const CrossSection::Point& p : line) {
      plot.push_back(at(p.along_mm, p.height_mm));
    }
    draw->AddPolyline(plot.data(), static_cast<int>(plot.size()), packed(ui.colours.text), 0, 1.8F);
  }
  const auto words = [&](ImVec2 where, const Eigen::Vector4f& colour, const std::string& text) {
    draw->AddText(ui.fonts.small, small, where, packed(colour), text.c_str(), nullptr, words_wide);
  };
  words({low.x + ui.px(0.6F), low.y + ui.px(0.2F)}, ui.colours.text, said_of(times));
  if (section.lowest_mm < 0) {
    const ImVec2 deep = at(section.lowest_along_mm, section.lowest_mm);
    draw->AddLine(at(section.lowest_along_mm, 0), deep, packed(ui.colours.red), 1.5F);
    words({deep.x + 4, deep.y - 2}, ui.colours.red,
          fmt::format("{} mm", decimal(-section.lowest_mm, 3, ui.preferences.language)));
  }
}

}  // namespace dubsar::ui
