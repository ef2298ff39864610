// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is asked in a box of its own: the window's settings, what tablet it is, and the signature.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "archive/seen_line.h"
#include "station/session_name.h"
#include "ui/operator/before_signing.h"
#include "ui/operator/operator_screen.h"
#include "ui/shell/face_texts.h"
#include "ui/shell/sound.h"

namespace dubsar::ui {

namespace {

constexpr float kRecordLines = 6;  ///< of a tablet

/// Begins a modal box of that width in the middle of the window, when it is open.
bool begin_box(UiContext& ui, const char* title, const char* id, bool& open, float width) {
  if (open) {
    ImGui::OpenPopup(id);
    open = false;
  }
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  // In the middle: the title of one that is as high as the window stays in it.
  ImGui::SetNextWindowSize({std::min(width, 0.92F * window.x), 0});
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  if (!ImGui::BeginPopupModal((std::string(title) + id).c_str(), nullptr,
                              ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    return false;
  }
  begin_asking(ui);
  if (ImGui::GetWindowPos().y >= 0) {
    ui.facts.insert("title-whole");
  }
  return true;
}

/// Ends a box with its last button.
void end_box(UiContext& ui, const char* close_name) {
  ImGui::SameLine();
  if (plain_button(ui, close_name, ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace

void OperatorScreen::draw_settings(UiContext& ui) {
  if (!begin_box(ui, ui.text(Text::kSettings), "###settings", open_settings_, ui.px(26))) {
    return;
  }
  Preferences& p = ui.preferences;
  ImGui::TextUnformatted(ui.text(Text::kLanguage));
  if (ImGui::RadioButton("English", p.language == Language::kEnglish)) {
    p.language = Language::kEnglish;
  }
  ui.target("english");
  ImGui::SameLine();
  if (ImGui::RadioButton("Deutsch", p.language == Language::kGerman)) {
    p.language = Language::kGerman;
  }
  ui.target("german");
  tick(ui, "dark", ui.text(Text::kDark), p.dark);
  tick(ui, "colour-blind", ui.text(Text::kColourBlind), p.blue_for_red);
  if (tick(ui, "sound", ui.text(Text::kSound), p.sound) && p.sound) {
    play(Sound::kDone);  // so that one hears whether it works
  }
  ImGui::TextUnformatted(ui.text(Text::kFontSize));
  if (plain_button(ui, "font-smaller", "A-")) {
    p.font_px = std::max(kSmallestFontPx, p.font_px - 2);
  }
  ImGui::SameLine();
  if (plain_button(ui, "font-larger", "A+")) {
    p.font_px = std::min(kLargestFontPx, p.font_px + 2);
  }
  ImGui::Separator();
  if (confirmed(ui, "close-settings", Text::kClose)) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

OperatorScreen::~OperatorScreen() {
  if (types_record_) {
    say_record(false);
  }
}

void OperatorScreen::say_record(bool anyway) {
  types_record_ = false;
  TabletRecord said = record_;
  said.cdli = check_cdli(record_.cdli).has_value() ? record_.cdli : said_record_.cdli;
  if (!(said == said_record_) || anyway) {
    session_.describe(said);
    said_record_ = said;
  }
}

void OperatorScreen::draw_tablet(UiContext& ui) {
  if (!begin_box(ui, ui.text(Text::kTablet), "###tablet", open_tablet_, ui.px(32))) {
    return;
  }
  // What is typed is kept when its line is left: a window that is killed meanwhile takes nothing with it. One
  // that is closed says it then.
  bool left_line = false;
  // Lines that letters make too high are scrolled through; what ends the box is always in sight.
  const float line_high = ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeightWithSpacing();
  const float most = 0.98F * ImGui::GetIO().DisplaySize.y - ImGui::GetCursorPosY() -
                     2 * ImGui::GetTextLineHeightWithSpacing() - ImGui::GetFrameHeightWithSpacing() -
                     ImGui::GetStyle().WindowPadding.y;
  const bool scrolls = kRecordLines * line_high > most;
  if (scrolls) {
    ImGui::BeginChild("lines", {0, most});
  }
  const auto line = [&](const char* name, Text label, std::string& value) {
    types_record_ = text_line(ui, name, ui.text(label), value) || types_record_;
    left_line = left_line || ImGui::IsItemDeactivatedAfterEdit();
  };
  line("museum-number", Text::kMuseumNumber, record_.museum_number);
  line("cdli", Text::kCdli, record_.cdli);
  const bool cdli_good = check_cdli(record_.cdli).has_value();
  if (!cdli_good) {
    coloured_text(ui.colours.bad, ui.text(Text::kCdliWrong));
  }
  line("collection", Text::kCollection, record_.collection);
  line("operator", Text::kOperator, record_.operator_name);
  line("rights", Text::kRights, record_.rights);
  line("notes", Text::kNotes, record_.notes);
  if (scrolls) {
    ImGui::EndChild();
  }
  ImGui::PushFont(ui.fonts.small);
  coloured_text(state_.record_kept ? ui.colours.faint : ui.colours.amber,
                ui.text(state_.record_kept ? Text::kKept : Text::kRecordNotKept));
  ImGui::PopFont();
  // Enter in a line leaves the line, as what reads a label into it says it too.
  const bool typing = ImGui::GetIO().WantTextInput;
  const bool close = typing ? plain_button(ui, "close-tablet", ui.text(Text::kClose), cdli_good)
                            : confirmed(ui, "close-tablet", Text::kClose, cdli_good);
  ImGui::SameLine();
  const bool next = plain_button(ui, "next-tablet", fmt::format("{}  N", ui.text(Text::kNextTablet)).c_str(),
                                 cdli_good && may_leave()) ||
                    (cdli_good && may_leave() && !ImGui::GetIO().WantTextInput && any_pressed({GLFW_KEY_N}));
  if (close || next || left_line) {
    ui.preferences.operator_name = record_.operator_name;
    say_record(close && !state_.record_kept);
  }
  if (next) {
    open_next();
  }
  if (close || next) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

std::string OperatorScreen::title_of(const UiContext& ui, Text what) const {
  const std::string& number = state_.record.museum_number;
  return fmt::format("{}: {}", ui.text(what),
                     seen_line(number.empty() ? session_name(session_.folder()) : number));
}

/// The largest of what is excused, with the reasons, and the page that has them all.
void OperatorScreen::draw_excused(UiContext& ui) {
  if (!state_.red_map || excused_mm2(*state_.red_map) <= 0) {
    return;
  }
  constexpr std::size_t kMostPlaces = 4;
  const Language language = ui.preferences.language;
  std::vector<std::string> lines;
  double others_mm2 = 0;
  for (const ExcusedPlaces& one : excused_places(*state_.red_map)) {
    if (lines.size() < kMostPlaces) {
      lines.push_back(filled(ui.text(Text::kExcusedPlace), ui.text(kFaceTexts[static_cast<int>(one.face)]),
                             area_words(one.area_mm2, language), translated(one.reason, language)));
    } else {
      others_mm2 += one.area_mm2;
    }
  }
  if (others_mm2 > 0) {
    lines.push_back(filled(ui.text(Text::kMoreExcused), area_words(others_mm2, language)));
  }
  std::error_code unknown;
  const std::filesystem::path page = whole_name(session_.folder()) / "export" / "checklist.html";
  if (std::filesystem::exists(page, unknown)) {
    lines.push_back(filled(ui.text(Text::kExcusedPage), seen_line(page.string())));
    ui.facts.insert("excused-page");
  }
  ImGui::PushFont(ui.fonts.small);
  const float wide = ImGui::GetContentRegionAvail().x;
  float high = 0;
  for (const std::string& line : lines) {
    high += ImGui::CalcTextSize(line.c_str(), nullptr, false, wide - ui.px(1)).y +
            ImGui::GetStyle().ItemSpacing.y;
  }
  // What letters make too high is scrolled through: the lines that are typed into stay in sight.
  ImGui::BeginChild("excused", {0, std::min(high, 0.35F * ImGui::GetIO().DisplaySize.y)});
  for (const std::string& line : lines) {
    coloured_text(is_much_excused(state_) ? ui.colours.amber : ui.colours.text, line.c_str());
  }
  ImGui::EndChild();
  ui.target("excused", Reach::kNone);
  ImGui::PopFont();
}

void OperatorScreen::draw_signing(UiContext& ui) {
  if (!begin_box(ui, title_of(ui, Text::kSign).c_str(), "###sign", open_sign_, ui.px(32))) {
    return;
  }
  const auto says = [](const std::string& text) {
    return text.find_first_not_of(" \t") != std::string::npos;
  };
  ImGui::TextWrapped("%s", ui.text(Text::kSignHint));
  for (const LiveScan& scan : state_.scans) {
    if (const std::string warning = scan_warning(scan, ui.preferences.language); !warning.empty()) {
      coloured_text(ui.colours.amber, warning.c_str());
    }
  }
  draw_excused(ui);
  const SigningReason reason = signing_reason(state_);
  if (is_damaged(state_)) {
    coloured_text(ui.colours.amber, ui.text(Text::kDamagedOrReason));
  }
  const bool enough = says(sign_name_) && (!reason.wanted || says(sign_incomplete_));
  // The first line that lacks has the cursor: whoever signs needs no mouse. So too when enter was too early.
  const bool appears = ImGui::IsWindowAppearing();
  const bool too_early = !appears && !enough && confirms(ui);
  sign_too_early_ = !enough && (too_early || (sign_too_early_ && !appears));
  bool asks = appears || too_early;
  const auto line = [&](const char* name, Text label, std::string& value) {
    const bool lacks = !says(value);
    if (std::exchange(asks, asks && !lacks) && lacks) {
      ImGui::SetKeyboardFocusHere();
    }
    const bool marked = lacks && sign_too_early_;
    const Eigen::Vector4f c = marked ? ui.colours.amber : ui.colours.text;
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(c.x(), c.y(), c.z(), c.w()));
    text_line(ui, name, ui.text(label), value);
    ImGui::PopStyleColor();
    if (marked) {
      ui.facts.insert(std::string("lacks.") + name);
    }
  };
  line("sign-name", Text::kSignName, sign_name_);
  text_line(ui, "sign-role", ui.text(Text::kSignRole), sign_role_);
  if (reason.wanted) {
    line("sign-incomplete", Text::kSignIncomplete, sign_incomplete_);
  } else if (reason.asked) {
    text_line(ui, "sign-incomplete", ui.text(Text::kSignIncomplete), sign_incomplete_);
  }
  // The line that has the cursor by itself must not cost a second escape.
  if (!enough && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    ImGui::CloseCurrentPopup();
  }
  if (confirmed(ui, "sign-now", Text::kSignNow, enough)) {
    SignOff wanted;
    wanted.name = sign_name_;
    wanted.role = sign_role_;
    wanted.incomplete = reason.asked && says(sign_incomplete_) ? sign_incomplete_ : std::string();
    ui.preferences.operator_name = sign_name_;
    session_.sign(wanted);
    ImGui::CloseCurrentPopup();
  }
  end_box(ui, "sign-close");
}

void OperatorScreen::draw_package(UiContext& ui) {
  if (!begin_box(ui, title_of(ui, Text::kPackage).c_str(), "###package", open_package_, ui.px(36))) {
    return;
  }
  ImGui::TextWrapped("%s", ui.text(Text::kPackageHint));
  text_line(ui, "package-folder", ui.text(Text::kPackageFolder), package_folder_);
  if (confirmed(ui, "package-now", Text::kPackageNow, !package_folder_.empty())) {
    session_.pack(package_folder_);
    ImGui::CloseCurrentPopup();
  }
  end_box(ui, "package-close");
}

void OperatorScreen::draw_next(UiContext& ui) {
  if (!begin_box(ui, ui.text(Text::kNextTablet), "###next", open_next_, ui.px(32))) {
    return;
  }
  text_line(ui, "next-folder", ui.text(Text::kNextFolder), next_folder_);
  ImGui::PushFont(ui.fonts.small);
  coloured_text(ui.colours.faint, ui.text(Text::kNextBeside));
  ImGui::PopFont();
  const bool conclusive = state_.red_map && state_.red_map->conclusive;
  if (state_.signed_off && !conclusive && !session_.device().empty()) {
    if (plain_button(ui, "scan-on", ui.text(Text::kScanOn), may_leave())) {
      session_.scan_now();
      ImGui::CloseCurrentPopup();
    }
  }
  if (next_folder_ != next_asked_for_) {
    next_found_.reset();
  }
  if (next_found_) {
    const FoundSession& found = *next_found_;
    const std::string name = found.record.museum_number.empty() ? next_folder_ : found.record.museum_number;
    const std::string asks = found.is_read ? filled(ui.text(Text::kNextIsThere), seen_line(name), found.scans)
                                           : std::string(ui.text(Text::kNextIsThereUnread));
    coloured_text(ui.colours.amber, asks.c_str());
    ui.facts.insert("next-is-there");
  }
  if (confirmed(ui, "next-now", next_found_ ? Text::kGoOn : Text::kNextNow,
                !next_folder_.empty() && may_leave())) {
    const std::filesystem::path next = whole_name(session_.folder()).parent_path() / next_folder_;
    const bool was_asked = next_found_.has_value();
    // A session of another tablet is gone on with only when it was said which it is.
    next_found_ = was_asked ? std::nullopt : session_found(next);
    next_asked_for_ = next_folder_;
    if (!next_found_) {
      next_session_ = next;
      ImGui::CloseCurrentPopup();
    }
  }
  end_box(ui, "next-close");
}

}  // namespace dubsar::ui
