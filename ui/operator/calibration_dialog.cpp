// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/calibration_dialog.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "station/verification.h"
#include "ui/gl/gl_window.h"
#include "ui/operator/camera_dialog.h"
#include "ui/shell/typed_number.h"

namespace dubsar::ui {

namespace {

constexpr const char* kPopup = "###calibration";
constexpr const char* kUsualBoard = "chessboard:9x6:25";
constexpr const char* kUsualPlace = "calibration/calibration.json";

void say(const Eigen::Vector4f& colour, const std::string& line) {
  coloured_text(colour, line.c_str());
}

void draw_outcome(UiContext& ui, const VerifyOutcome& outcome) {
  for (const MeasuredBall& ball : outcome.is.balls) {
    say(ui.colours.text, filled(ui.text(Text::kBallLine), ball.certified + 1, 1e3 * ball.form_mm,
                                1e3 * ball.size_mm, ball.samples));
  }
  for (const MeasuredSpacing& one : outcome.is.spacings) {
    say(ui.colours.text, filled(ui.text(Text::kSpacingLine), one.a + 1, one.b + 1, 1e3 * one.error_mm));
  }
  if (outcome.is.flatness_mm) {
    say(ui.colours.text, filled(ui.text(Text::kFlatnessLine), 1e3 * *outcome.is.flatness_mm));
  }
  for (const std::string& line : outcome.is.failed) {
    say(ui.colours.bad, translated(line, ui.preferences.language));
  }
  const bool passed = outcome.is.passed();
  ui.facts.insert(passed ? "verify-passed" : "verify-failed");
  say(passed ? ui.colours.good : ui.colours.bad,
      fmt::format("{}: {}", outcome.artefact.name,
                  ui.text(passed ? Text::kVerifyPassed : Text::kVerifyFailed)));
  if (outcome.time_unknown) {
    say(ui.colours.amber, ui.text(Text::kVerifyTimeUnknown));
  }
  if (outcome.camera_unknown) {
    say(ui.colours.amber, ui.text(Text::kVerifyCameraUnknown));
  }
  if (!outcome.log.empty()) {
    say(ui.colours.faint, outcome.log);
  }
}

void draw_report(UiContext& ui, const CalibrateOutcome& outcome) {
  const RigCalibration& rig = outcome.report.rig;
  const CalibrationQuality& q = rig.quality;
  say(ui.colours.text, filled(ui.text(Text::kCameraLine), q.corner_rms_px, q.corner_rms_um, q.board_views));
  if (rig.has_laser) {
    say(ui.colours.text, filled(ui.text(Text::kLaserLine), q.stripe_rms_px, q.stripe_rms_um, q.stripe_views));
    say(ui.colours.text, filled(ui.text(Text::kVolumeLine), q.volume_sigma_um));
  }
  if (rig.has_motion && q.stage_positions > 0) {
    say(ui.colours.text, filled(ui.text(Text::kStageLine), q.stage_rms_um, q.stage_positions));
  }
  for (const std::string& line : outcome.left_out) {
    say(ui.colours.faint, translated(line, ui.preferences.language));
  }
  for (const std::string& line : q.left_out) {
    say(ui.colours.faint, translated(line, ui.preferences.language));
  }
  for (const std::string& line : outcome.report.missing) {
    say(ui.colours.amber,
        fmt::format("{}: {}", ui.text(Text::kNextPose), translated(line, ui.preferences.language)));
  }
  ui.facts.insert(outcome.report.missing.empty() ? "calibration-whole" : "calibration-lacks");
}

}  // namespace

std::string care_line(const RigCare& care, Language language) {
  if (!care.last) {
    return text_of(Text::kNeverVerified, language);
  }
  if (!care.last->passed) {
    return text_of(Text::kVerifiedBadly, language);
  }
  if (!care.age_days) {
    return text_of(Text::kVerifiedSometime, language);
  }
  return filled(text_of(care.is_due() ? Text::kVerifiedLongAgo : Text::kVerifiedToday, language),
                care.is_due() ? *care.age_days : 24 * *care.age_days);
}

void CalibrationDialog::open() {
  opening_ = true;
  const std::string device = session_.device();
  const bool is_other = std::exchange(device_, device) != device;
  verify_.scan = device;
  motion_ = stage_kind_of(device);
  const std::optional<RigCare> care = care_of(device);
  if (care || is_other) {  // what was measured with this one is no word about the one before
    verify_.calibration = care ? care->verified : std::string();
  }
  if (care && verify_.artefact.empty()) {
    verify_.artefact = (std::filesystem::path(care->verified).parent_path() / "artefact.toml").string();
  }
  if (const std::string place = calibration_place_of(device); !place.empty() || is_other) {
    out_ = place.empty() ? kUsualPlace : place;
  }
  if (calibrate_.board.empty()) {
    calibrate_.board = kUsualBoard;
    calibrate_.folder = "calibration";
  }
}

void CalibrationDialog::draw_verify(UiContext& ui, const LiveState& state) {
  ImGui::TextWrapped("%s", ui.text(Text::kVerifyHow));
  if (state.care) {
    say(state.care->is_due() ? ui.colours.amber : ui.colours.good,
        care_line(*state.care, ui.preferences.language));
  }
  text_line(ui, "verify-artefact", ui.text(Text::kArtefactFile), verify_.artefact);
  text_line(ui, "verify-scan", ui.text(Text::kVerifyScan), verify_.scan);
  text_line(ui, "verify-calibration", ui.text(Text::kCalibrationFile), verify_.calibration);
  ui.facts.insert("verifies " + (verify_.calibration.empty() ? "nothing" : verify_.calibration));
  if (state.verification) {
    ImGui::Separator();
    draw_outcome(ui, *state.verification);
  }
}

/// What the stage does, and how warm the room is: of all pictures.
void CalibrationDialog::draw_stage(UiContext& ui) {
  const float end = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  const auto offer = [&](const char* name, Text text, MotionKind kind) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float wide =
        ImGui::GetFrameHeight() + style.ItemInnerSpacing.x + ImGui::CalcTextSize(ui.text(text)).x;
    // Beside the one before where it fits, else below.
    if (kind != MotionKind::kLinear && ImGui::GetItemRectMax().x + style.ItemSpacing.x + wide <= end) {
      ImGui::SameLine();
    }
    if (ImGui::RadioButton(ui.text(text), motion_ == kind)) {
      motion_ = kind;
    }
    ui.target(name);
  };
  offer("stage-linear", Text::kStageLinear, MotionKind::kLinear);
  offer("stage-turntable", Text::kStageTurntable, MotionKind::kTurntable);
  offer("stage-mirror", Text::kStageMirror, MotionKind::kGalvanometer);
  short_text(ui, "temperature", temperature_, ui.px(5));
  ImGui::SameLine();
  ImGui::TextUnformatted(ui.text(Text::kTemperature));
  calibrate_.temperature_c = typed_number(temperature_);
}

/// A rig's laser is put on and off for it; how it is with a camera alone, the operator sees to.
void CalibrationDialog::take_shot() {
  if (!wanted_ || shooting_.valid()) {
    return;
  }
  const auto view = session_.camera();
  if (!view || !view->image) {
    wanted_.reset();  // the camera is gone, which is said below
    return;
  }
  const bool lit = wanted_->shot == CalibrationShot::kLaser;
  if (view->lit && *view->lit != lit) {
    session_.light_camera(lit);
    return;
  }
  shooting_ = std::async(std::launch::async, [view, wanted = *wanted_] {
    auto said = add_calibration_shot(wanted.folder, wanted.words,
                                     {wanted.shot, *view->image, view->camera_serial, wanted.position});
    wake_window();
    return said;
  });
  wanted_.reset();
}

void CalibrationDialog::draw_shots(UiContext& ui) {
  const auto view = session_.camera();
  const bool may = view && view->image && !wanted_ && !shooting_.valid() && !calibrate_.folder.empty();
  const std::optional<double> position = typed_number(position_);
  const bool mirror = motion_ == MotionKind::kGalvanometer;
  const auto offer = [&](const char* name, Text text, CalibrationShot shot, bool enabled) {
    if (plain_button(ui, name, ui.text(text), may && enabled)) {
      wanted_ = Shot{shot,
                     {calibrate_.board, motion_, calibrate_.temperature_c},
                     position.value_or(0),
                     calibrate_.folder};
    }
  };
  offer("shot-board", Text::kShotBoard, CalibrationShot::kBoard, !mirror || position.has_value());
  ImGui::SameLine();
  offer("shot-laser", Text::kShotLaser, CalibrationShot::kLaser, true);
  ImGui::SameLine();
  offer("shot-dark", Text::kShotDark, CalibrationShot::kDark, true);
  offer("shot-stop", Text::kShotStop, CalibrationShot::kStop, !mirror && position.has_value());
  ImGui::SameLine();
  short_text(ui, "shot-position", position_, ui.px(5));
  ImGui::SameLine();
  ImGui::TextUnformatted(mirror ? ui.text(Text::kMirrorAt) : motion_ == MotionKind::kTurntable ? "°" : "mm");
  take_shot();
  if (shooting_.valid() && shooting_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const Result<std::string> said = shooting_.get();
    shot_failed_ = !said;
    shot_said_ = said ? *said : said.error().line();
  }
  if (!shot_said_.empty()) {
    ui.facts.insert("shot " + shot_said_);
    say(shot_failed_ ? ui.colours.bad : ui.colours.good,
        shot_failed_ ? translated(shot_said_, ui.preferences.language) : shot_said_);
  }
}

void CalibrationDialog::draw_calibrate(UiContext& ui, const LiveState& state) {
  ImGui::TextWrapped("%s", ui.text(Text::kCalibrateHow));
  text_line(ui, "calibrate-folder", ui.text(Text::kPictureFolder), calibrate_.folder);
  text_line(ui, "calibrate-board", ui.text(Text::kBoard), calibrate_.board);
  draw_stage(ui);
  draw_shots(ui);
  text_line(ui, "calibrate-out", ui.text(Text::kCalibrationFile), out_);
  ui.facts.insert("keeps-to " + out_);
  if (state.calibration) {
    ImGui::Separator();
    draw_report(ui, *state.calibration);
  }
}

/// What a page is for: below it, where no scrolling hides it.
void CalibrationDialog::draw_action(UiContext& ui, const LiveState& state) {
  if (verifying_) {
    if (plain_button(ui, "verify-now", ui.text(Text::kVerifyNow),
                     !session_.is_occupied() && !verify_.artefact.empty() && !verify_.scan.empty())) {
      session_.verify(verify_);
    }
    return;
  }
  const bool room = temperature_.empty() || calibrate_.temperature_c;
  const bool may = !session_.is_occupied() && !calibrate_.folder.empty() && room;
  if (plain_button(ui, "calibrate-now", ui.text(Text::kCalibrateNow), may)) {
    calibrate_.out.clear();
    session_.calibrate(calibrate_);
  }
  ImGui::SameLine();
  if (plain_button(ui, "calibrate-keep", ui.text(Text::kCalibrateKeep),
                   may && state.calibration && !out_.empty())) {
    calibrate_.out = out_;
    session_.calibrate(calibrate_);
  }
}

void CalibrationDialog::draw_camera(UiContext& ui, ImVec2 size) {
  const auto view = session_.camera();
  if (!view || view->width == 0) {
    coloured_text(ui.colours.faint, ui.text(Text::kNoPicture));
    return;
  }
  ui.facts.insert("camera-picture");
  if (view != shown_) {
    texture_.upload(view->width, view->height, 3, hatched(*view).data(), false);
    shown_ = view;
  }
  const float scale =
      std::min(size.x / static_cast<float>(view->width),
               (size.y - 2 * ImGui::GetTextLineHeightWithSpacing()) / static_cast<float>(view->height));
  ImGui::Image(picture_of(texture_.id()),
               {scale * static_cast<float>(view->width), scale * static_cast<float>(view->height)});
  const bool good = view->exposure.advice == ExposureAdvice::kGood;
  coloured_text(good ? ui.colours.good : ui.colours.amber,
                exposure_line(view->exposure, ui.preferences.language).c_str());
}

void CalibrationDialog::draw(UiContext& ui, const LiveState& state) {
  open_ = open_ || opening_;
  if (!begin_wide_box(ui, ui.text(Text::kCalibration), kPopup, opening_)) {
    if (std::exchange(open_, false)) {
      session_.watch_camera(false);
      wanted_.reset();
      shown_.reset();
    }
    return;
  }
  if (ImGui::RadioButton(ui.text(Text::kVerifyPage), verifying_)) {
    verifying_ = true;
    wanted_.reset();
    session_.watch_camera(false);
  }
  ui.target("page-verify");
  ImGui::SameLine();
  if (ImGui::RadioButton(ui.text(Text::kCalibratePage), !verifying_)) {
    verifying_ = false;
  }
  ui.target("page-calibrate");
  const bool refused = !session_.is_occupied() && state.error;
  const std::string told = session_.is_occupied() ? std::string()
                           : refused              ? translated(*state.error, ui.preferences.language)
                                                  : translated(state.notice, ui.preferences.language);
  const ImFont* small = ui.fonts.small;
  const float gap = ImGui::GetStyle().ItemSpacing.y;
  const float told_high =
      session_.is_occupied() ? 2 * (small->FontSize + gap) + 2 * ImGui::GetStyle().FramePadding.y
      : told.empty()
          ? 0.0F
          : gap +
                small->CalcTextSizeA(small->FontSize, 1e6F, ImGui::GetContentRegionAvail().x, told.c_str()).y;
  const float foot =
      std::min(told_high, 0.3F * ImGui::GetContentRegionAvail().y) + gap + ImGui::GetFrameHeightWithSpacing();
  const ImVec2 room{ImGui::GetContentRegionAvail().x, ImGui::GetContentRegionAvail().y - foot};
  const float right = verifying_ ? 0 : 0.42F * room.x;
  ImGui::BeginChild("page", {room.x - right, room.y}, true);
  if (verifying_) {
    draw_verify(ui, state);
  } else {
    draw_calibrate(ui, state);
  }
  ImGui::EndChild();
  if (!verifying_) {
    session_.watch_camera(true);
    ImGui::SameLine();
    ImGui::BeginChild("camera", {0, room.y}, true);
    draw_camera(ui, ImGui::GetContentRegionAvail());
    ImGui::EndChild();
  }
  ImGui::PushFont(ui.fonts.small);
  if (session_.is_occupied()) {
    if (!state.stage.empty()) {
      if (plain_button(ui, "stop-calibration", ui.text(Text::kStop))) {
        session_.stop();
      }
      ImGui::SameLine();
      job_bar(ui, time_left_, state.stage, state.fraction);
    }
  } else if (!told.empty()) {
    ui.facts.insert(refused                              ? "calibration-refused"
                    : state.notice.starts_with("kept: ") ? "calibration-kept"
                                                         : "calibration-told");
    coloured_text(refused ? ui.colours.bad : ui.colours.faint, told.c_str());
  }
  ImGui::PopFont();
  draw_action(ui, state);
  ImGui::SameLine();
  if (plain_button(ui, "close-calibration", ui.text(Text::kClose))) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace dubsar::ui
