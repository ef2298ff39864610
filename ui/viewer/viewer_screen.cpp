// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/viewer/viewer_screen.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "ui/view/pin_marks.h"
#include "ui/viewer/hand.h"

namespace dubsar::ui {

Eigen::Vector2f shown_range(const std::vector<float>& values) {
  constexpr std::size_t kLooked = 100000;
  std::vector<float> some;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / kLooked);
  for (std::size_t i = 0; i < values.size(); i += stride) {
    if (std::isfinite(values[i])) {
      some.push_back(values[i]);
    }
  }
  if (some.empty()) {
    return {0, 1};
  }
  std::ranges::sort(some);
  float low = some[some.size() / 50];
  float high = some[some.size() - 1 - some.size() / 50];
  if (low < 0 && high > 0) {
    high = std::max(high, -low);
    low = -high;
  }
  return {low, std::max(high, low + 1e-6F)};
}

ViewerScreen::ViewerScreen(MeshViewing& viewing, std::filesystem::path pictures, bool has_session)
    : viewing_(viewing), pictures_(std::move(pictures)), has_session_(has_session) {}

void ViewerScreen::take_state(UiContext& ui) {
  if (std::exchange(openness_due_, false)) {
    viewing_.want(MeshField::kOpenness);
  }
  {
    const TimedWork timed(ui.watch, "what is known of the mesh");
    state_ = viewing_.state();
  }
  // They may be others, and at other places in the table; also while their mesh is not shown yet.
  if (state_.wedges != seen_wedges_) {
    seen_wedges_ = state_.wedges;
    wedge_ = -1;
    marked_.clear();
    splitting_ = false;
    split_places_.clear();
  }
  bool is_new = false;
  {
    const TimedWork timed(ui.watch, "a mesh to the graphics card");
    is_new = prepared_.update(state_, surface_);
  }
  if (is_new) {
    openness_due_ = true;
    unfinished_ = true;
    shown_openness_.reset();
    shown_values_.reset();
    tape_.clear();
    clicked_px_.clear();
    drop_polygon();
    clear_selected();
    give_up_picture();
    wedge_ = -1;
    look_at(Face::kObverse);
    if (field_ && field_ != MeshField::kOpenness && !state_.fields.contains(*field_)) {
      field_.reset();  // nobody has asked for it of this mesh
    }
    // The numbers that were shown went with the mesh that they were of.
    if (look_.overlay == Overlay::kValue || !tells(prepared_.shown(), look_.overlay)) {
      look_.overlay = Overlay::kClay;
    }
    if (!prepared_.shown().colours.empty() && look_.overlay == Overlay::kClay) {
      look_.overlay = Overlay::kColours;
    }
  }
  unfinished_ = unfinished_ || prepared_.arrives();
  if (!is_current()) {
    return;  // what is known is of another mesh than the one that is drawn
  }
  const auto field_values = [&](MeshField field) -> std::shared_ptr<const std::vector<float>> {
    const auto known = state_.fields.find(field);
    return known == state_.fields.end() ? nullptr : known->second;
  };
  // What a picture that is kept is drawn from stays until the last of its tiles.
  if (const auto openness = field_values(MeshField::kOpenness);
      openness && openness != shown_openness_ && !still_) {
    const TimedWork timed(ui.watch, "ambient occlusion to the graphics card");
    set_openness(prepared_.shown(), *openness);
    surface_.set_traits(prepared_.shown().traits);
    shown_openness_ = openness;
  }
  if (field_) {
    if (const auto values = field_values(*field_); values && values != shown_values_ && !still_) {
      const TimedWork timed(ui.watch, "an overlay to the graphics card");
      surface_.set_values(of_shown(prepared_.shown(), *values));
      look_.value_range = shown_range(*values);
      look_.overlay = Overlay::kValue;
      shown_values_ = values;
    } else if (!values && state_.stage.empty() && !openness_due_) {
      field_.reset();  // it was stopped, or there is none of such a mesh
    }
  }
  ui.facts.insert("shown");
  if (untouched_) {
    ui.facts.insert(fmt::format("looks-at.{}", to_string(looked_at_)));
  }
  if (state_.wedges) {
    ui.facts.insert("wedges");
  }
  if (state_.is_part) {
    ui.facts.insert("part");
  }
  if (state_.written != seen_written_) {
    seen_written_ = state_.written;
    if (!seen_written_.empty()) {
      picture_note_ = filled(ui.text(Text::kPictureKept), seen_written_.front().string());
    }
  }
  if (state_.stage.empty() && !openness_due_) {
    ui.facts.insert("idle");
  }
  if (surface_.whole()) {
    ui.facts.insert("whole");
  }
}

void ViewerScreen::look_at(Face face) {
  camera_.eye_from_model = eye_towards(face, state_.tablet_from_model);
  camera_.fit(prepared_.shown().box_mm, aspect_);
  untouched_ = true;
  looked_at_ = face;
}

void ViewerScreen::draw(UiContext& ui, ImVec2 size) {
  unfinished_ = false;
  take_state(ui);
  draw_picture_on(ui);
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("viewer", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  // In large letters the panels are narrower: the surface is what is looked at.
  const bool narrow = room.x < ui.px(60);
  const float left = ui.px(narrow ? 14 : 15.5F);
  const float right = !state_.wedges ? 0 : ui.px(narrow ? 11.5F : 16.5F);
  const float gaps = ImGui::GetStyle().ItemSpacing.x * (state_.wedges ? 2.0F : 1.0F);
  draw_panel(ui, {left, room.y});
  ImGui::SameLine();
  draw_surface(ui, {room.x - left - right - gaps, room.y});
  if (state_.wedges) {
    ImGui::SameLine();
    draw_wedge_table(ui, {right, room.y}, !narrow);
  }
  ImGui::End();
  if (!ImGui::GetIO().WantTextInput) {
    for (int k = 0; k < kFaceCount; ++k) {
      if (ImGui::IsKeyPressed(GLFW_KEY_1 + k, false)) {
        look_at(static_cast<Face>(k));
      }
    }
  }
}

void ViewerScreen::draw_surface(UiContext& ui, ImVec2 size) {
  ImGui::BeginChild("surface", size, false,
                    ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  const ImVec2 end{origin.x + size.x, origin.y + size.y};
  ImGui::InvisibleButton("##surface", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle |
                             ImGuiButtonFlags_MouseButtonRight);
  ui.target("surface", Reach::kNone);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(origin, end, packed(ui.colours.text, 0.05F), 6);
  if (aspect_ != size.x / size.y) {
    aspect_ = size.x / size.y;
    if (untouched_ && !surface_.empty()) {
      camera_.fit(prepared_.shown().box_mm, aspect_);
    }
  }
  if (surface_.empty() || prepared_.is_empty(state_)) {
    const std::string words = state_.error ? translated(*state_.error, ui.preferences.language)
                                           : ui.text(prepared_.waiting_text(state_));
    draw->AddText(nullptr, 0, {origin.x + ui.px(2), origin.y + ui.px(2)},
                  packed(state_.error ? ui.colours.bad : ui.colours.faint), words.c_str(), nullptr,
                  size.x - ui.px(4));
    if (state_.error) {
      ui.facts.insert("error");
    }
    ImGui::EndChild();
    return;
  }
  use_pointer(origin, size);
  look_.red = ui.colours.red.head<3>();
  look_.amber = ui.colours.amber.head<3>();
  bool draws_on = false;
  {
    const TimedWork timed(ui.watch, "the surface's picture");
    draws_on = surface_.draw(camera_, look_, static_cast<int>(size.x), static_cast<int>(size.y));
  }
  if (draws_on) {
    unfinished_ = true;
  } else {
    take_places(ui);
    go_on_selecting(ui);
  }
  draw->AddImage(picture_of(surface_.texture()), origin, end, {0, 1}, {1, 0});
  const TimedWork timed(ui.watch, "lines over the surface");
  draw->PushClipRect(origin, end, true);
  if (show_wedges_ && state_.wedges) {
    draw_wedges(ui, origin, size);
  }
  if (show_pins_ && !state_.is_part) {
    draw_pin_marks(ui, camera_, origin, size, pins_);
  }
  draw_section(ui, origin, size);
  draw_tape(ui, origin, size);
  draw_split_places(ui, origin, size);
  draw_polygon(ui, origin);
  ui::draw_scale_bar(ui, camera_, origin, size);
  draw_legend(ui, origin, size);
  draw->PopClipRect();
  ImGui::EndChild();
}

void ViewerScreen::use_pointer(ImVec2 origin, ImVec2 size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (use_hand(origin, size, camera_, look_, dragged_)) {
    untouched_ = false;
  }
  drop_what_is_of_another_view(size);
  if (ImGui::IsItemActivated()) {  // ImGui says it at the press, a click counts at the release
    double_clicked_ = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  }
  if (ImGui::IsItemDeactivated() && !dragged_ && ImGui::IsMouseReleased(ImGuiMouseButton_Left)) {
    const Eigen::Vector2f px(io.MousePos.x - origin.x, io.MousePos.y - origin.y);
    if (tool_ == Tool::kSelect) {
      if (!polygon_closed_) {
        add_corner(px);
      }
    } else if (takes_places()) {
      clicked_px_.push_back(px);
    } else {
      if (tool_ == Tool::kCorrect) {
        mark(wedge_at(px, size));
      }
      choose(wedge_at(px, size), false);
      scroll_to_wedge_ = wedge_ >= 0;
    }
  }
}

/// Clicks and corners are pixels: turned, moved, nearer or in a picture of another size they would be other
/// places. Whatever moves the camera between two frames is noticed here, before they are used.
void ViewerScreen::drop_what_is_of_another_view(ImVec2 size) {
  if (clicked_camera_ != camera_ || clicked_size_.x != size.x || clicked_size_.y != size.y) {
    clicked_camera_ = camera_;
    clicked_size_ = size;
    clicked_px_.clear();
    drop_polygon();
  }
}

bool ViewerScreen::takes_places() const {
  return tool_ == Tool::kMeasure || tool_ == Tool::kSection || (tool_ == Tool::kCorrect && splitting_);
}

void ViewerScreen::take_places(UiContext& ui) {
  if (clicked_px_.empty() || !surface_.whole()) {
    return;
  }
  const TimedWork timed(ui.watch, "a place on the surface");
  for (const Eigen::Vector2f& px : std::exchange(clicked_px_, {})) {
    const auto place = surface_.point_at(px);
    if (!place || !takes_places()) {
      continue;
    }
    if (tool_ == Tool::kCorrect) {
      split_places_.push_back(*place);
      continue;
    }
    if (tape_.size() == 2) {
      tape_.clear();
    }
    tape_.push_back(*place);
    if (tool_ == Tool::kSection && tape_.size() == 2) {
      cut_between_places();
    }
  }
}

void ViewerScreen::choose(int wedge, bool go_there) {
  wedge_ = wedge;
  untouched_ = untouched_ && !go_there;
  if (!go_there || wedge < 0 || !state_.wedges) {
    return;
  }
  const Wedge& chosen = (*state_.wedges)[static_cast<std::size_t>(wedge)];
  const Eigen::Vector3f normal = chosen.surface_normal.cast<float>();
  if (normal.norm() > 0.5F && (camera_.eye_from_model * normal).z() < 0.5F) {
    const Eigen::Vector3f now = camera_.eye_from_model * normal;
    camera_.eye_from_model =
        (Eigen::Quaternionf::FromTwoVectors(now, Eigen::Vector3f::UnitZ()) * camera_.eye_from_model)
            .normalized();
  }
  camera_.centre_mm = chosen.depth_point_mm.cast<float>();
}

std::filesystem::path ViewerScreen::unused_file(const std::string& what,
                                                std::initializer_list<const char*> endings) {
  const std::string stem = state_.name.empty() ? "model" : std::filesystem::path(state_.name).stem().string();
  for (int k = 1;; ++k) {
    const std::filesystem::path numbered = pictures_ / fmt::format("{}_{}_{:02}", stem, what, k);
    const bool is_free = std::ranges::none_of(endings, [&](const char* ending) {
      const std::filesystem::path file = numbered.string() + ending;
      std::error_code error;
      return handed_out_.contains(file) || std::filesystem::exists(file, error);
    });
    if (is_free) {
      for (const char* ending : endings) {
        handed_out_.insert(numbered.string() + ending);
      }
      return numbered.string() + *endings.begin();
    }
  }
}

}  // namespace dubsar::ui
