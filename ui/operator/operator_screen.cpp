// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/operator_screen.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "station/packing.h"
#include "ui/operator/window_title.h"
#include "ui/shell/give_back.h"
#include "ui/shell/sound.h"
#include "ui/view/pin_marks.h"

namespace dubsar::ui {

namespace {

constexpr float kModelAspect = 1.2F;  ///< that a model is fitted to, where its place is not narrower

}  // namespace

std::vector<unsigned char> coloured(const GridPicture& picture, const UiContext& ui) {
  std::vector<unsigned char> out(picture.shade.size() * 3);
  const Eigen::Vector3f ground = 255 * (ui.preferences.dark ? Eigen::Vector3f(0.08F, 0.08F, 0.09F)
                                                            : Eigen::Vector3f(0.85F, 0.84F, 0.82F));
  for (std::size_t i = 0; i < picture.shade.size(); ++i) {
    const float shade = picture.shade[i];
    const Eigen::Vector3f c = picture.state[i] == CellState::kNone ? ground
                              : picture.state[i] == CellState::kRed
                                  ? Eigen::Vector3f((95 + 0.63F * shade) * ui.colours.red.head<3>())
                                  : Eigen::Vector3f(shade * ui.colours.clay.head<3>());
    for (int k = 0; k < 3; ++k) {
      out[3 * i + static_cast<std::size_t>(k)] = static_cast<unsigned char>(std::clamp(c[k], 0.0F, 255.0F));
    }
  }
  return out;
}

OperatorScreen::OperatorScreen(LiveSession& session)
    : session_(session), camera_box_(session), calibration_(session) {}

void OperatorScreen::take_state(UiContext& ui) {
  {
    const TimedWork timed(ui.watch, "what is known of the session");
    state_ = session_.state();
  }
  std::unique_ptr<ReadyModel> ready;
  {
    const TimedWork timed(ui.watch, "the model to the graphics card");
    ready = prepared_.update(state_, model_);
  }
  if (ready) {
    const TimedWork timed(ui.watch, "what belongs to the model");
    model_.show_points(ready->red.get());
    model_has_red_ = ready->red != nullptr;
    pose_.show(ready->few);
    unfinished_ = true;  // the next model may wait already
    if (!camera_set_) {
      camera_.eye_from_model = Eigen::Quaternionf(
          Eigen::AngleAxisf(-0.45F, Eigen::Vector3f::UnitX()) *
          Eigen::Quaternionf(Eigen::Matrix3f(ready->tablet_from_model.rotation.cast<float>())));
      camera_set_ = true;
    }
    model_box_mm_ = ready->whole->box_mm;
    fit_model();
    giving_back_ = give_back(std::move(ready));
  }
  draws_on_ = prepared_.arrives();
  unfinished_ = unfinished_ || prepared_.busy();
  if (!record_taken_ && state_.phase != LivePhase::kReading) {
    record_ = said_record_ = state_.record;
    if (record_.operator_name.empty()) {
      record_.operator_name = ui.preferences.operator_name;
    }
    record_taken_ = true;
  }
  constexpr const char* kPhases[] = {"still",   "reading",   "opening", "moving",    "scanning", "judging",
                                     "waiting", "finishing", "signing", "measuring", "packing"};
  ui.facts.insert(kPhases[static_cast<int>(state_.phase)]);
  if (state_.phase == LivePhase::kStill && state_.error) {
    ui.facts.insert("stopped");
  }
  if (state_.red_map && state_.red_map->conclusive) {
    ui.facts.insert("conclusive");
  }
  if (state_.silence) {
    ui.facts.insert("device-silent");
  }
  if (ui.preferences.language == Language::kGerman) {
    ui.facts.insert("german-words");
  }
  if (state_.signed_off) {
    ui.facts.insert("signed");
  }
  if (!state_.package.empty()) {
    ui.facts.insert("packed");
  }
  if (state_.phase == LivePhase::kWaiting) {
    ui.facts.insert(state_.last_not_taken_up ? "waiting-unsure" : "waiting-turn");
  }
  if (!model_.empty()) {
    ui.facts.insert("model-shown");
  }
  if (session_.busy()) {
    ui.facts.insert("busy");
  } else {
    ui.facts.insert("idle");
  }
  if (state_.care) {
    ui.facts.insert(state_.care->is_due() ? "verify-due" : "verified-today");
  }
  ui.facts.insert("scans." + std::to_string(state_.scans.size()));
  if (looked_at_) {
    ui.facts.insert(fmt::format("looks-at.{}", to_string(*looked_at_)));
  }
}

void OperatorScreen::sound_out(const UiContext& ui) {
  const LivePhase before = std::exchange(heard_phase_, state_.phase);
  if (!ui.preferences.sound || before == state_.phase) {
    return;
  }
  // The operator is wanted, or it is over; a session that was only read makes no noise.
  if (state_.phase == LivePhase::kWaiting) {
    play(state_.last_not_taken_up ? Sound::kFailed : Sound::kDone);
  } else if (state_.phase == LivePhase::kStill && (before != LivePhase::kReading || state_.error)) {
    play(state_.error ? Sound::kFailed : Sound::kDone);
  }
}

void OperatorScreen::draw(UiContext& ui, ImVec2 size) {
  unfinished_ = draws_on_ = false;
  take_state(ui);
  sound_out(ui);
  const bool has_device = !session_.device().empty();
  const Statement statement = statement_of(state_, has_device, ui.preferences.wording());
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("operator", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings);
  const float gap = ImGui::GetStyle().ItemSpacing.y;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float top = statement_high_px(ui, statement, room);
  const float strip = std::min(ui.px(8.2F), 0.2F * room.y);  // large letters leave the checklist its room
  const float middle = room.y - top - strip - 2 * gap;
  const float left = ui.px(13.5F);
  const float right = std::min(ui.px(19), 0.3F * room.x);
  draw_statement(ui, statement, {room.x, top});
  draw_left(ui, {left, middle});
  ImGui::SameLine();
  draw_model(ui, {room.x - left - right - 2 * ImGui::GetStyle().ItemSpacing.x, middle}, statement.may_point);
  const ImVec2 model_end = ImGui::GetItemRectMax();
  ImGui::SameLine();
  draw_right(ui, {right, middle});
  draw_strip(ui, {room.x, strip});
  if (statement.may_halt) {
    draw_halt(ui, model_end);
  }
  ImGui::End();

  if (const auto uri = devices_.draw(ui)) {
    session_.set_device(*uri);
    ui.preferences.device = *uri;
  }
  if (auto hint = pairs_.draw(ui)) {
    session_.ask(std::move(*hint));
  }
  for (LabelPins& labels : pins_.draw(ui)) {
    session_.ask(std::move(labels));
  }
  camera_box_.draw(ui, state_);
  calibration_.draw(ui, state_);
  draw_settings(ui);
  draw_tablet(ui);
  draw_signing(ui);
  draw_package(ui);
  draw_next(ui);
  act(statement, ui);
}

std::string OperatorScreen::title() const {
  return window_title(state_.record.museum_number, session_.folder(), session_.device());
}

std::vector<ShownPin> OperatorScreen::pins_on_model() const {
  std::vector<ScanPose> poses;
  for (const LiveScan& scan : state_.scans) {
    if (!scan.dropped && scan.pose) {
      poses.push_back(*scan.pose);
      poses.back().id = scan.id;
    }
  }
  return state_.pins ? shown_pins(*state_.pins, poses) : std::vector<ShownPin>();
}

void OperatorScreen::undo() {
  if (const LiveScan* last = newest_standing(state_)) {  // the one that they saw when they pressed the key
    session_.ask(DropScan{last->id, "undone by the operator"});
  }
}

void OperatorScreen::open_signing(const UiContext& ui) {
  if (sign_name_.empty()) {
    sign_name_ = !record_.operator_name.empty() ? record_.operator_name : ui.preferences.operator_name;
  }
  open_sign_ = true;
}

void OperatorScreen::open_package() {
  if (package_folder_.empty()) {
    package_folder_ = usual_package_of(std::filesystem::absolute(session_.folder())).string();
  }
  open_package_ = true;
}

void OperatorScreen::open_next() {
  next_folder_ = next_session_name(session_.folder()).string();
  next_found_.reset();
  open_next_ = true;
}

void OperatorScreen::look_at(Face face) {
  if (!model_.empty()) {
    camera_.eye_from_model = eye_towards(face, state_.tablet_from_model);
    fit_model();
    looked_at_ = face;
  }
}

void OperatorScreen::fit_model() {
  camera_.fit(model_box_mm_, model_aspect_);
  is_fitted_ = true;
}

void OperatorScreen::act(const Statement& statement, const UiContext& ui) {
  if (ImGui::GetIO().WantTextInput || ui.facts.contains("dialog")) {
    return;
  }
  for (int k = 0; k < kFaceCount; ++k) {
    if (any_pressed({GLFW_KEY_1 + k})) {
      look_at(static_cast<Face>(k));
    }
  }
  // Keys, and what foot pedals send: F9 to F11, or page down, page up and end.
  if (statement.may_scan && any_pressed({GLFW_KEY_SPACE, GLFW_KEY_F9, GLFW_KEY_PAGE_DOWN})) {
    session_.scan_now();
  } else if (statement.may_next && any_pressed({GLFW_KEY_SPACE, GLFW_KEY_F9, GLFW_KEY_PAGE_DOWN})) {
    open_next();
  } else if (statement.may_undo && any_pressed({GLFW_KEY_BACKSPACE, GLFW_KEY_F10, GLFW_KEY_PAGE_UP})) {
    undo();
  } else if (any_pressed({GLFW_KEY_F11, GLFW_KEY_END}) || enter_pressed(ui)) {
    if (statement.may_sign) {
      open_signing(ui);
    } else if (statement.may_finish) {
      session_.finish();
    } else if (statement.may_pack) {
      open_package();
    }
  } else if (may_leave() && any_pressed({GLFW_KEY_N})) {
    open_next();
  } else if (statement.may_stop && any_pressed({GLFW_KEY_ESCAPE})) {
    session_.stop();
  } else if (statement.may_point && any_pressed({GLFW_KEY_P})) {
    open_pairs();
  }
}

/// For the newest scan that is not sure.
void OperatorScreen::open_pairs() {
  for (const LiveScan& scan : state_.scans) {
    if (!scan.dropped && scan.pose && scan.pose->status != PoseStatus::kRegistered) {
      pairs_.open(scan, state_.scans);
    }
  }
}

/// Over the model, where nothing else is pressed while something moves.
void OperatorScreen::draw_halt(UiContext& ui, ImVec2 model_end) {
  const ImVec2 size{ui.px(17), ui.px(5)};
  ImGui::SetCursorScreenPos({model_end.x - size.x, model_end.y - size.y});
  ImGui::BeginChild("halt", size);
  if (big_button(ui, "emergency-stop", ui.text(Text::kHalt), ui.text(Text::kKeyHalt), size,
                 ButtonKind::kDanger)) {
    session_.halt();
  }
  ImGui::EndChild();
}

void OperatorScreen::draw_model(UiContext& ui, ImVec2 size, bool asks_for_places) {
  ImGui::BeginChild("model", size, false, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("##model", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  ImGui::SetItemAllowOverlap();
  ui.target("model", Reach::kNone);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 end{origin.x + size.x, origin.y + size.y};
  draw->AddRectFilled(origin, end, packed(ui.colours.text, 0.06F), 6);
  const bool simulated = is_simulated(session_.device());
  const auto say_simulated = [&] {  // over whatever is shown
    if (simulated) {
      draw->AddText(ui.fonts.normal, ui.fonts.normal->FontSize,
                    {origin.x + ui.px(0.5F), origin.y + ui.px(0.5F) + ui.fonts.small->FontSize},
                    packed(ui.colours.amber), ui.text(Text::kSimulated), nullptr, size.x - ui.px(1));
      ui.facts.insert("simulated");
    }
  };
  if (const float aspect = std::min(kModelAspect, size.x / size.y); aspect != model_aspect_) {
    model_aspect_ = aspect;
    if (is_fitted_) {
      fit_model();
    }
  }
  if (model_.empty()) {
    say_simulated();
    const ImVec2 text = ImGui::CalcTextSize(ui.text(Text::kNoModelYet));
    draw->AddText({origin.x + 0.5F * (size.x - text.x), origin.y + 0.5F * size.y}, packed(ui.colours.faint),
                  ui.text(Text::kNoModelYet));
    ImGui::EndChild();
    return;
  }
  const ImGuiIO& io = ImGui::GetIO();
  const auto part = [&](ImVec2 at) {
    return Eigen::Vector2f((at.x - origin.x - 0.5F * size.x) / (0.5F * size.y),
                           -(at.y - origin.y - 0.5F * size.y) / (0.5F * size.y));
  };
  // In the frame of the press the pointer has come from anywhere: a finger taps where it did not point
  // before.
  const bool drags = ImGui::IsItemActive() && !ImGui::IsItemActivated();
  if (drags && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    is_fitted_ = false;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || io.KeyShift) {
      camera_.pan({io.MouseDelta.x, io.MouseDelta.y}, size.y);
    } else {
      looked_at_.reset();
      camera_.drag(part({io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y}),
                   part(io.MousePos));
    }
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
    const Eigen::Vector2f at = part(io.MousePos);
    is_fitted_ = false;
    camera_.zoom(std::pow(0.88F, io.MouseWheel), {at.x() * size.y / size.x, at.y()}, size.x / size.y);
  }
  OrbitCamera enough = camera_;
  enough.fit(model_box_mm_, size.x / size.y);
  if (camera_.half_height_mm >= enough.half_height_mm) {
    ui.facts.insert("model-whole");
  }
  Look look;
  look.occlusion = false;
  look.red = ui.colours.red.head<3>();
  look.amber = ui.colours.amber.head<3>();
  const bool conclusive = state_.red_map && state_.red_map->conclusive;
  if (!model_has_red_ && !conclusive) {
    // A session that is being read: the mesh itself says what is sparse, until it is known what is excused.
    look.overlay = Overlay::kFlags;
  }
  {
    const TimedWork timed(ui.watch, "the model's picture");
    draws_on_ = model_.draw(camera_, look, static_cast<int>(size.x), static_cast<int>(size.y)) || draws_on_;
    unfinished_ = unfinished_ || draws_on_;
  }
  draw->AddImage(picture_of(model_.texture()), origin, end, {0, 1}, {1, 0});
  draw_pin_marks(ui, camera_, origin, size, pins_on_model());
  draw->AddText(ui.fonts.small, ui.fonts.small->FontSize, {origin.x + ui.px(0.5F), origin.y + ui.px(0.3F)},
                packed(ui.colours.faint), ui.text(Text::kModel));
  say_simulated();
  if (state_.red_map && !state_.red_map->conclusive) {
    const std::string red =
        filled(ui.text(Text::kRedArea), area_words(red_mm2(*state_.red_map), ui.preferences.language));
    // Above the model: below are its edge and the buttons.
    const float wide = ImGui::CalcTextSize(red.c_str()).x;
    draw->AddText({end.x - ui.px(0.5F) - wide, origin.y + ui.px(0.3F)}, packed(ui.colours.red), red.c_str());
  }
  if (asks_for_places) {
    const ImVec2 button{ui.px(13), ui.px(2.9F)};
    ImGui::SetCursorScreenPos({end.x - button.x - ui.px(0.6F), end.y - button.y - ui.px(0.6F)});
    if (big_button(ui, "show-places", ui.text(Text::kPointPairs), "P", button, ButtonKind::kMain)) {
      open_pairs();
    }
  }
  ImGui::EndChild();
}

}  // namespace dubsar::ui
