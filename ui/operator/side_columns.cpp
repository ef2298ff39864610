// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The columns beside the model: faces, tablet and machine on the left, the scan as it grows and the next turn
// on the right.
#include <algorithm>

#include "ui/operator/before_signing.h"
#include "ui/operator/operator_screen.h"
#include "ui/shell/face_texts.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

namespace {

Eigen::Vector4f colour_of(const UiContext& ui, const FaceState& face) {
  return face.lacks ? ui.colours.red : face.excused ? ui.colours.amber : ui.colours.faint;
}

/// A tick, a box, or a box with a dash, beside the colour: colour alone tells nothing to some.
void draw_mark(const UiContext& ui, const FaceState& face, float box) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  if (face.whole) {
    draw->AddLine({at.x + 0.1F * box, at.y + 0.55F * box}, {at.x + 0.4F * box, at.y + 0.85F * box},
                  packed(ui.colours.good), 0.16F * box);
    draw->AddLine({at.x + 0.4F * box, at.y + 0.85F * box}, {at.x + 0.95F * box, at.y + 0.15F * box},
                  packed(ui.colours.good), 0.16F * box);
  } else {
    draw->AddRect({at.x + 0.1F * box, at.y + 0.15F * box}, {at.x + 0.9F * box, at.y + 0.9F * box},
                  packed(colour_of(ui, face)), 2, 0, 0.12F * box);
    if (face.excused) {
      draw->AddLine({at.x + 0.3F * box, at.y + 0.53F * box}, {at.x + 0.7F * box, at.y + 0.53F * box},
                    packed(ui.colours.amber), 0.16F * box);
    }
  }
  ImGui::Dummy({box, box});
  ImGui::SameLine();
}

/// Small, beside what was drawn last where it fits, else below it.
void draw_note(const UiContext& ui, const FaceState& face, float room_end, float indent) {
  ImGui::PushFont(ui.fonts.small);
  ImGui::SameLine();
  const bool beside = ImGui::GetCursorScreenPos().x + ImGui::CalcTextSize(face.note.c_str()).x < room_end;
  if (beside) {
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + 0.2F * ui.fonts.small->FontSize);
  } else {
    ImGui::NewLine();
    ImGui::Indent(indent);
  }
  coloured_text(colour_of(ui, face), face.note.c_str());
  if (!beside) {
    ImGui::Unindent(indent);
  }
  ImGui::PopFont();
}

}  // namespace

/// Its mark and its name; a click turns the model to it.
void OperatorScreen::draw_face(UiContext& ui, Face which, const FaceState& face, Text name) {
  ImGui::BeginGroup();
  draw_mark(ui, face, ImGui::GetTextLineHeight());
  ImGui::TextUnformatted(ui.text(name));
  ImGui::EndGroup();
  if (ImGui::IsItemClicked()) {
    look_at(which);
  }
  ui.target(fmt::format("face.{}", to_string(which)));
  if (face.whole || face.excused) {
    ui.facts.insert(fmt::format("face.{}.{}", to_string(which), face.whole ? "whole" : "excused"));
  }
}

/// All six are seen at once: where letters are too large for a line each, in short first.
void OperatorScreen::draw_faces(UiContext& ui) {
  const float end = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  if (ImGui::GetContentRegionAvail().y < (kFaceCount + 1) * ImGui::GetTextLineHeightWithSpacing()) {
    constexpr int kInRow = 3;
    const float left = ImGui::GetCursorPosX();
    const float wide = ImGui::GetContentRegionAvail().x / kInRow;
    ImGui::PushFont(ui.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ui.px(0.2F), 2});
    for (int k = 0; k < kFaceCount; ++k) {
      const FaceState face = face_state(state_, static_cast<Face>(k), ui.preferences.wording());
      if (k % kInRow > 0) {
        ImGui::SameLine(left + static_cast<float>(k % kInRow) * wide);
      }
      draw_face(ui, static_cast<Face>(k), face, kShortFaceTexts[k]);
    }
    ImGui::PopStyleVar();
    ImGui::PopFont();
    ImGui::Separator();
  }
  ImGui::TextUnformatted(ui.text(Text::kChecklist));
  for (int k = 0; k < kFaceCount; ++k) {
    const FaceState face = face_state(state_, static_cast<Face>(k), ui.preferences.wording());
    const float box = ImGui::GetTextLineHeight();
    draw_face(ui, static_cast<Face>(k), face, kFaceTexts[k]);
    if (!face.note.empty()) {
      draw_note(ui, face, end, box + ImGui::GetStyle().ItemSpacing.x);
    }
  }
}

/// Whatever the statement asks for just then, and also of a session that is opened again.
void OperatorScreen::draw_unplaced(UiContext& ui) {
  const std::string scans = scans_without_place(state_);
  if (scans.empty()) {
    return;
  }
  const bool is_one = scans.find(',') == std::string::npos;
  ImGui::PushFont(ui.fonts.small);
  coloured_text(ui.colours.amber,
                filled(ui.text(is_one ? Text::kUnplacedScan : Text::kUnplacedScans), scans).c_str());
  ImGui::PopFont();
  ui.target("unplaced", Reach::kNone);
}

/// "Session whole". The stored checklist knows how it was; damage and loss since then are worse.
void OperatorScreen::draw_session_line(UiContext& ui) {
  std::string damaged = damaged_scans(state_);
  if (const std::string taken_out = damaged_scans_taken_out(state_); !taken_out.empty()) {
    damaged += (damaged.empty() ? "" : ", ") + taken_out;
  }
  const bool is_lost = !state_.lost_records.empty() || !scans_of_lost_records(state_).empty();
  if (!state_.checklist && !is_damaged(state_) && !is_lost) {
    return;
  }
  ImGui::Separator();
  ImGui::PushFont(ui.fonts.small);
  ImGui::TextUnformatted(ui.text(Text::kStore));
  ImGui::SameLine();
  if (!damaged.empty()) {
    coloured_text(ui.colours.bad, filled(ui.text(Text::kStoreScansDamaged), damaged).c_str());
  } else if (is_lost) {
    coloured_text(ui.colours.amber, ui.text(Text::kStoreLost));
  } else if (is_session_whole(state_)) {
    coloured_text(ui.colours.good, ui.text(Text::kStoreWhole));
    ui.facts.insert("session-whole");
  } else {
    coloured_text(ui.colours.bad, ui.text(Text::kStoreDamaged));
  }
  ImGui::PopFont();
}

void OperatorScreen::draw_left(UiContext& ui, ImVec2 size) {
  ImGui::BeginChild("left", size, true, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  // The buttons below are wanted without scrolling, whatever the size of the letters.
  // They leave the six faces in short their two lines.
  const float gap = ImGui::GetStyle().ItemSpacing.y;
  const float faces = 2.3F * ui.fonts.small->FontSize;
  const float row =
      std::clamp((ImGui::GetContentRegionAvail().y - faces - 4 * gap) / 3, ui.px(1.4F), ui.px(2.1F));
  const float buttons = 3 * row + 4 * gap;
  ImGui::BeginChild("list", {0, ImGui::GetContentRegionAvail().y - buttons});
  draw_faces(ui);
  for (const LiveScan& scan : state_.scans) {
    if (!scan_warning(scan, ui.preferences.language).empty()) {
      ui.facts.insert(fmt::format("scan.{}.warned", scan.id));
      ImGui::PushFont(ui.fonts.small);
      coloured_text(ui.colours.amber,
                    filled(ui.text(Text::kScanSays), scan.id, ui.text(Text::kWarned)).c_str());
      ImGui::PopFont();
    }
  }
  draw_unplaced(ui);
  draw_session_line(ui);
  if (state_.checklist) {
    const Checklist& list = *state_.checklist;
    ImGui::PushFont(ui.fonts.small);
    ImGui::TextUnformatted(filled(ui.text(Text::kDiskFree), list.disk_free_gib).c_str());
    ImGui::TextUnformatted(ui.text(Text::kCalibration));
    coloured_text(ui.colours.faint, list.calibration_age_days
                                        ? filled(ui.text(Text::kDaysOld), *list.calibration_age_days).c_str()
                                        : ui.text(Text::kNoCalibration));
    ImGui::PopFont();
  }
  if (state_.care) {
    ImGui::PushFont(ui.fonts.small);
    coloured_text(state_.care->is_due() ? ui.colours.amber : ui.colours.good,
                  care_line(*state_.care, ui.preferences.language).c_str());
    ImGui::PopFont();
  }
  ImGui::EndChild();
  ImGui::Separator();
  const ImVec2 wide{-1, row};
  std::string tablet = ui.text(Text::kTablet);
  if (!state_.record.museum_number.empty()) {
    tablet += ": " + state_.record.museum_number;
  }
  const bool is_kept = state_.record_kept;
  if (big_button(ui, "tablet", tablet.c_str(), is_kept ? nullptr : ui.text(Text::kNotKept), wide)) {
    open_tablet_ = true;
  }
  const ImVec2 half{0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x), wide.y};
  const auto narrow = [&](const char* name, Text text, ButtonKind kind, bool enabled) {
    return big_button(ui, name, ui.text(text), nullptr, half, kind, enabled);
  };
  const bool has_device = !session_.device().empty();
  if (narrow("device", Text::kDevice, has_device ? ButtonKind::kPlain : ButtonKind::kMain,
             !session_.is_occupied())) {
    devices_.open(session_.device());
  }
  ImGui::SameLine();
  if (narrow("camera", Text::kCamera, ButtonKind::kPlain, has_device)) {
    camera_box_.open();
  }
  if (narrow("calibration", Text::kCalibration, ButtonKind::kPlain, !session_.is_occupied())) {
    calibration_.open();
  }
  ImGui::SameLine();
  if (narrow("settings", Text::kSettings, ButtonKind::kPlain, true)) {
    open_settings_ = true;
  }
  ImGui::EndChild();
}

void OperatorScreen::draw_growing(UiContext& ui, ImVec2 size) {
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImGui::Dummy(size);
  ui.target("growing");
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 end{origin.x + size.x, origin.y + size.y};
  draw->AddRectFilled(origin, end, packed(ui.colours.text, 0.06F), 6);
  {
    const TimedWork timed(ui.watch, "the growing scan");
    growing_.update(session_, ui);
  }
  if (growing_.rows() >= 10) {
    ui.facts.insert("rows.10");
  }
  if (growing_.rows() == 0) {
    draw->AddText(ui.fonts.small, ui.fonts.small->FontSize, {origin.x + ui.px(0.6F), origin.y + ui.px(0.5F)},
                  packed(ui.colours.faint), ui.text(Text::kNoScanYet));
    return;
  }
  // Rows come from the top; the grid is as wide as the panel, and what is newest stays in view.
  const float scale = std::min(size.x / static_cast<float>(growing_.cols()),
                               size.y / static_cast<float>(std::max(growing_.rows(), growing_.cols() / 2)));
  const float width = scale * static_cast<float>(growing_.cols());
  const float height = scale * static_cast<float>(growing_.rows());
  const float x = origin.x + 0.5F * (size.x - width);
  draw->AddImage(picture_of(growing_.texture()), {x, origin.y}, {x + width, origin.y + height}, {0, 0},
                 {1, growing_.filled()});
  if (state_.phase == LivePhase::kScanning) {
    draw->AddLine({x, origin.y + height}, {x + width, origin.y + height}, packed(ui.colours.ghost), 2);
  }
}

void OperatorScreen::draw_right(UiContext& ui, ImVec2 size) {
  ImGui::BeginChild("right", size, true, ImGuiWindowFlags_NoScrollbar);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const bool works = session_.busy() && !state_.stage.empty() && state_.phase != LivePhase::kWaiting;
  // Of a scan that is unsure the statement says it all.
  const bool tells =
      !works && !state_.notice.empty() && !(state_.phase == LivePhase::kWaiting && state_.last_not_taken_up);
  const std::string notice = tells ? translated(state_.notice, ui.preferences.language) : std::string();
  // As high as its words take, but the pictures keep their half.
  const ImFont* small = ui.fonts.small;
  const float notice_high =
      tells ? small->CalcTextSizeA(small->FontSize, 1e6F, room.x, notice.c_str()).y + line : 0.0F;
  const float foot = works   ? 2.6F * line
                     : tells ? std::min(std::max(notice_high, 2.6F * line), 0.5F * room.y)
                             : 0.0F;
  const bool shows_next = state_.next && state_.next->placement && state_.mesh;
  const float pictures = room.y - foot - (shows_next ? 2 : 1) * line;
  const float growing =
      shows_next ? (state_.phase == LivePhase::kWaiting ? 0.35F : 0.5F) * pictures : pictures;
  ImGui::TextUnformatted(ui.text(Text::kScanGrowing));
  draw_growing(ui, {room.x, growing});
  if (shows_next) {
    ImGui::TextUnformatted(ui.text(Text::kNextPose));
    unfinished_ =
        pose_.draw(ui, *state_.next, {room.x, pictures - growing - 2 * ImGui::GetStyle().ItemSpacing.y}) ||
        unfinished_;
  }
  if (works) {
    ImGui::PushFont(ui.fonts.small);
    job_bar(ui, time_left_, state_.stage, state_.fraction);
    ImGui::PopFont();
  } else if (tells) {
    ImGui::BeginChild("notice");  // what is longer than the half is scrolled to
    ImGui::PushFont(ui.fonts.small);
    coloured_text(ui.colours.faint, notice.c_str());
    ImGui::PopFont();
    ui.target("notice");
    ImGui::EndChild();
  }
  ImGui::EndChild();
}

}  // namespace dubsar::ui
