// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What stands beside the surface: views, light, colours, tools, facts, and the table of wedges.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cfloat>

#include "core/wedge_length.h"
#include "ui/shell/face_texts.h"
#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

struct FieldChoice {
  Text text;
  MeshField field;
};
constexpr FieldChoice kFields[] = {{Text::kOverlayCurvature, MeshField::kMeanCurvature},
                                   {Text::kOverlayOpenness, MeshField::kOpenness},
                                   {Text::kOverlaySigma, MeshField::kSigma},
                                   {Text::kOverlayHeight, MeshField::kHeight},
                                   {Text::kOverlayMsii, MeshField::kInvariant}};
struct PlainChoice {
  Text text;
  Overlay overlay;
};
constexpr PlainChoice kPlain[] = {{Text::kOverlayClay, Overlay::kClay},
                                  {Text::kOverlayColours, Overlay::kColours},
                                  {Text::kOverlayReliability, Overlay::kReliability},
                                  {Text::kOverlayScans, Overlay::kScans},
                                  {Text::kOverlayFlags, Overlay::kFlags}};

/// "obv. ", before a line of it.
std::string side_words(const UiContext& ui, const std::optional<Face>& side) {
  return side ? fmt::format("{} ", ui.text(kShortFaceTexts[static_cast<std::size_t>(*side)])) : std::string();
}

/// How much of something, from 0 to 3; the keys left and right change it by a tenth.
void part_slider(UiContext& ui, const char* name, Text text, float& value) {
  constexpr float kMost = 3;
  constexpr float kStep = 0.1F;
  // ImGui writes its numbers with a point: the word for it is given instead.
  const std::string word = decimal(static_cast<double>(value), 1, ui.preferences.language);
  ImGui::SetNextItemWidth(ui.px(5));
  ImGui::SliderFloat(ui.text(text), &value, 0, kMost, word.c_str());
  if (ui.target(name, Reach::kSlid)) {
    const float by = (ImGui::IsKeyPressed(GLFW_KEY_RIGHT, false) ? kStep : 0) -
                     (ImGui::IsKeyPressed(GLFW_KEY_LEFT, false) ? kStep : 0);
    value = by == 0 ? value : std::clamp(value + by, 0.0F, kMost);
  }
  ui.facts.insert(fmt::format("{}={:.1f}", name, value));
}

/// By the order of kWedgeFeatures.
constexpr std::array<Text, kWedgeFeatures.size()> kFeatures{
    Text::kFeatureDepth, Text::kFeatureLength1,  Text::kFeatureLength2,  Text::kFeatureLength3,
    Text::kFeatureSlope, Text::kFeatureOpening1, Text::kFeatureOpening2, Text::kFeatureOpening3,
    Text::kFeatureFace1, Text::kFeatureFace2,    Text::kFeatureFace3};

}  // namespace

void ViewerScreen::draw_light(UiContext& ui) {
  ImGui::TextUnformatted(ui.text(Text::kLookClay));
  ImGui::PushFont(ui.fonts.small);
  tick(ui, "lamp", ui.text(Text::kLamp), look_.lamp);
  tick(ui, "shadows", ui.text(Text::kShadows), look_.shadows);
  tick(ui, "occlusion", ui.text(Text::kOcclusion), look_.occlusion);
  tick(ui, "flat", ui.text(Text::kFlat), look_.flat);
  part_slider(ui, "radiance", Text::kRadiance, look_.radiance);
  part_slider(ui, "depth-shading", Text::kDepthShading, look_.depth_shading);
  ImGui::PopFont();
}

void ViewerScreen::draw_overlay_choice(UiContext& ui) {
  ImGui::TextUnformatted(ui.text(Text::kOverlay));
  ImGui::SetNextItemWidth(-1);
  Text now = Text::kOverlayClay;
  for (const PlainChoice& choice : kPlain) {
    now = !field_ && choice.overlay == look_.overlay ? choice.text : now;
  }
  for (const FieldChoice& choice : kFields) {
    now = field_ == choice.field ? choice.text : now;
  }
  // What is too long for it is in the small letters.
  const float room =
      ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - ImGui::GetStyle().FramePadding.x;
  const bool in_small = ImGui::CalcTextSize(ui.text(now)).x > room;
  if (in_small) {
    ImGui::PushFont(ui.fonts.small);
  }
  if (ImGui::CalcTextSize(ui.text(now)).x <= room) {
    ui.facts.insert("overlay-whole");
  }
  if (ImGui::BeginCombo("##overlay", ui.text(now), ImGuiComboFlags_HeightLargest)) {
    for (const PlainChoice& choice : kPlain) {
      if (!tells(prepared_.shown(), choice.overlay)) {
        continue;
      }
      if (ImGui::Selectable(ui.text(choice.text), now == choice.text)) {
        field_.reset();
        shown_values_.reset();
        look_.overlay = choice.overlay;
      }
      ui.target(fmt::format("overlay.{}", text_of(choice.text, Language::kEnglish)));
    }
    for (const FieldChoice& choice : kFields) {
      if (choice.field == MeshField::kSigma && !state_.fields.contains(MeshField::kSigma)) {
        continue;
      }
      if (ImGui::Selectable(ui.text(choice.text), now == choice.text)) {
        field_ = choice.field;
        shown_values_.reset();
        look_.overlay = Overlay::kClay;  // until its numbers are there: another field has its own
        viewing_.want(choice.field);
      }
      ui.target(fmt::format("overlay.{}", text_of(choice.text, Language::kEnglish)));
    }
    ImGui::EndCombo();
  }
  if (in_small) {
    ImGui::PopFont();
  }
  ui.target("overlay");
}

void ViewerScreen::draw_facts(UiContext& ui) {
  ImGui::PushFont(ui.fonts.small);
  if (surface_.buffers() != nullptr) {
    coloured_text(ui.colours.faint,
                  filled(ui.text(Text::kFaces), grouped(prepared_.shown().faces.size())).c_str());
    coloured_text(ui.colours.faint,
                  filled(ui.text(Text::kVertices), grouped(prepared_.shown().positions.size())).c_str());
    coloured_text(
        ui.colours.faint,
        filled(ui.text(Text::kGraphicsMemory), static_cast<double>(surface_.graphics_bytes()) / 1e6).c_str());
    ui.target("graphics-memory");
  }
  if (prepared_.shown().left_out > 0) {
    coloured_text(ui.colours.amber,
                  filled(ui.text(Text::kLeftOut), grouped(prepared_.shown().left_out)).c_str());
  }
  if (prepared_.shown().instead_of_faces > 0) {
    ui.facts.insert("fewer-faces");
    coloured_text(ui.colours.amber,
                  filled(ui.text(Text::kFewerFaces), grouped(prepared_.shown().faces.size()),
                         grouped(prepared_.shown().instead_of_faces))
                      .c_str());
  }
  ImGui::PopFont();
}

void ViewerScreen::draw_tools(UiContext& ui) {
  ImGui::PushFont(ui.fonts.small);
  const auto tool = [&](const char* name, Text text, Tool which) {
    if (ImGui::RadioButton(ui.text(text), tool_ == which)) {
      tool_ = which;
      tape_.clear();
      drop_polygon();
    }
    ui.target(name);
  };
  tool("tool-turn", Text::kMove, Tool::kTurn);
  ImGui::SameLine();
  tool("tool-measure", Text::kMeasure, Tool::kMeasure);
  tool("tool-section", Text::kSection, Tool::kSection);
  ImGui::SameLine();
  tool("tool-select", Text::kSelect, Tool::kSelect);
  if (state_.wedges) {
    tool("tool-correct", Text::kCorrect, Tool::kCorrect);
  }
  if (tool_ == Tool::kMeasure) {
    coloured_text(ui.colours.faint, ui.text(Text::kMeasureHint));
  } else if (tool_ == Tool::kSection) {
    draw_section_panel(ui);
  } else if (tool_ == Tool::kSelect) {
    draw_selecting(ui);
  } else if (tool_ == Tool::kCorrect && state_.wedges) {
    draw_correcting(ui);
  }
  ImGui::PopFont();
}

/// What is wanted whatever else is open stays in view below: how far a job is, its end, and pictures.
void ViewerScreen::draw_foot(UiContext& ui) {
  ImGui::Separator();
  if (!state_.stage.empty()) {
    ImGui::PushFont(ui.fonts.small);
    if (plain_button(ui, "stop", ui.text(Text::kStop))) {
      viewing_.stop();
    }
    ImGui::SameLine();
    job_bar(ui, time_left_, state_.stage, state_.fraction);
    ImGui::PopFont();
  }
  draw_picture_foot(ui);
  ImGui::PushFont(ui.fonts.small);
  for (const Error& doubt : state_.mesh_doubts) {
    ui.facts.insert("mesh-doubt");
    coloured_text(ui.colours.bad, translated(doubt, ui.preferences.language).c_str());
  }
  if (state_.error && !surface_.empty()) {
    ui.facts.insert("error");
    coloured_text(ui.colours.bad, translated(*state_.error, ui.preferences.language).c_str());
  }
  if (!picture_note_.empty()) {
    coloured_text(ui.colours.faint, picture_note_.c_str());
  }
  ImGui::PopFont();
}

void ViewerScreen::draw_panel(UiContext& ui, ImVec2 size) {
  ImGui::BeginChild("panel", size, true, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  // As high as the foot was in the last frame: what it holds changes seldom.
  ImGui::BeginChild("list", {0, -std::max(1.0F, foot_px_)});
  if (has_session_) {
    if (plain_button(ui, "back", ui.text(Text::kBackToScan))) {
      wants_scanning_ = true;
    }
  } else {
    ImGui::TextUnformatted(state_.name.c_str());
  }
  if (state_.is_part && plain_button(ui, "whole-mesh", ui.text(Text::kWholeMesh))) {
    viewing_.leave_part();
  }
  ImGui::Separator();
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  ImGui::PushFont(ui.fonts.small);
  for (int k = 0; k < kFaceCount; ++k) {
    const std::string name = fmt::format("view.{}", to_string(static_cast<Face>(k)));
    std::string key = fmt::format("{}  {}", k + 1, ui.text(kFaceTexts[k]));
    if (ImGui::CalcTextSize(key.c_str()).x > half - ui.px(0.4F)) {
      key = fmt::format("{}  {}", k + 1, ui.text(kShortFaceTexts[k]));
    }
    if (big_button(ui, name.c_str(), key.c_str(), nullptr, {half, ui.px(1.9F)}, ButtonKind::kPlain,
                   !surface_.empty())) {
      look_at(static_cast<Face>(k));
    }
    if (k % 2 == 0) {
      ImGui::SameLine();
    }
  }
  ImGui::PopFont();
  ImGui::Separator();
  draw_tools(ui);
  ImGui::Separator();
  draw_light(ui);
  ImGui::Separator();
  draw_overlay_choice(ui);
  ImGui::Separator();
  if (!state_.wedges) {
    if (plain_button(ui, "analyse", ui.text(Text::kAnalyse),
                     !prepared_.shown().faces.empty() && state_.stage.empty())) {
      viewing_.analyse();
    }
  } else {
    tick(ui, "show-wedges", ui.text(Text::kWedges), show_wedges_);
  }
  if (!pins_.empty()) {
    tick(ui, "show-pins", ui.text(Text::kPins), show_pins_);
  }
  ImGui::Separator();
  draw_facts(ui);
  ImGui::EndChild();
  const float from = ImGui::GetCursorPosY();
  draw_foot(ui);
  if (const float foot_px = ImGui::GetCursorPosY() - from; foot_px != foot_px_) {
    foot_px_ = foot_px;
    unfinished_ = true;
  }
  ImGui::EndChild();
}

/// How the wedges are distributed over one of the features that they are compared by.
void ViewerScreen::draw_histogram(UiContext& ui) {
  constexpr std::size_t kBins = 24;
  const Text chosen = kFeatures[histogram_feature_];
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##feature", ui.text(chosen), ImGuiComboFlags_HeightLargest)) {
    for (std::size_t f = 0; f < kFeatures.size(); ++f) {
      if (ImGui::Selectable(ui.text(kFeatures[f]), f == histogram_feature_)) {
        histogram_feature_ = f;
        histogram_wedges_.reset();
      }
      ui.target(fmt::format("feature.{}", kWedgeFeatures[f]));
    }
    ImGui::EndCombo();
  }
  ui.target("feature");
  if (histogram_wedges_ != state_.wedges) {
    histogram_wedges_ = state_.wedges;
    histogram_ = histogram_of(*state_.wedges, histogram_feature_, kBins);
  }
  ui.facts.insert(fmt::format("histogram.{}", kWedgeFeatures[histogram_feature_]));
  ImGui::PlotHistogram("##bins", histogram_.bins.data(), static_cast<int>(kBins), 0, nullptr, 0, FLT_MAX,
                       {ImGui::GetContentRegionAvail().x, ui.px(3.5F)});
  // Below the ends of the bars, over which they could not be read.
  ImGui::TextUnformatted(decimal(histogram_.least, 2, ui.preferences.language).c_str());
  const std::string most = decimal(histogram_.most, 2, ui.preferences.language);
  ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(most.c_str()).x);
  ImGui::TextUnformatted(most.c_str());
  if (!histogram_.note.empty()) {
    ui.facts.insert("histogram-of-some");
    coloured_text(ui.colours.faint, translated(histogram_.note, ui.preferences.language).c_str());
  }
}

void ViewerScreen::draw_wedge_table(UiContext& ui, ImVec2 size, bool with_length) {
  ImGui::BeginChild("wedges", size, true);
  const std::vector<Wedge>& wedges = *state_.wedges;
  ImGui::TextUnformatted(fmt::format("{}: {}", ui.text(Text::kWedges), wedges.size()).c_str());
  ImGui::PushFont(ui.fonts.small);
  for (const Error& doubt : state_.doubts) {
    ui.facts.insert("doubt");
    coloured_text(ui.colours.amber, translated(doubt, ui.preferences.language).c_str());
  }
  draw_histogram(ui);
  if (ImGui::BeginTable(
          "table", with_length ? 4 : 3,
          ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn(ui.text(Text::kWedgeNumber));
    ImGui::TableSetupColumn(ui.text(Text::kOrder));
    ImGui::TableSetupColumn(fmt::format("{} mm", ui.text(Text::kDepth)).c_str());
    if (with_length) {
      ImGui::TableSetupColumn(fmt::format("{} mm", ui.text(Text::kLength)).c_str());
    }
    ImGui::TableHeadersRow();
    ImGuiListClipper rows;
    rows.Begin(static_cast<int>(wedges.size()));
    while (rows.Step()) {
      for (int k = rows.DisplayStart; k < rows.DisplayEnd; ++k) {
        const Wedge& wedge = wedges[static_cast<std::size_t>(k)];
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        if (ImGui::Selectable(
                fmt::format("{}{}##{}", wedge.id, wedge.by_hand == ByHand::kNo ? "" : " *", k).c_str(),
                wedge_ == k, ImGuiSelectableFlags_SpanAllColumns)) {
          choose(k, true);
          if (tool_ == Tool::kCorrect && !splitting_) {
            mark(k);
          }
        }
        ui.target(fmt::format("wedge.{}", wedge.id));
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(wedge.place.line <= 0
                                   ? "-"
                                   : fmt::format("{}{}.{}", side_words(ui, wedge.place.side),
                                                 wedge.place.line, wedge.place.order)
                                         .c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(decimal(wedge.depth_mm, 2, ui.preferences.language).c_str());
        if (with_length) {
          ImGui::TableNextColumn();
          const auto leading = static_cast<std::size_t>(std::clamp(wedge.directional_edge, 0, 2));
          const std::string mark = length_is_guess(wedge, leading) ? "~" : "";  // as in the drawings
          ImGui::TextUnformatted(
              (mark + decimal(wedge.edge_lengths_mm[leading], 2, ui.preferences.language)).c_str());
        }
      }
    }
    if (scroll_to_wedge_ && wedge_ >= 0) {
      ImGui::SetScrollY(static_cast<float>(wedge_) * rows.ItemsHeight - ui.px(6));
      scroll_to_wedge_ = false;
    }
    ImGui::EndTable();
  }
  ui.facts.insert(wedge_ >= 0 ? fmt::format("chosen.{}", wedges[static_cast<std::size_t>(wedge_)].id)
                              : std::string("chosen.none"));
  ImGui::PopFont();
  ImGui::EndChild();
}

}  // namespace dubsar::ui
