// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Selections: drawn by polygons, kept under a name, shown again, written, analysed alone.
#include <algorithm>
#include <chrono>

#include "archive/seen_line.h"
#include "ui/gl/gl_window.h"
#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

/// Kept selections that are listed before the list scrolls.
constexpr int kMostListed = 4;
/// Of a part: what is written of it, and what a person may have said of another one of its number.
constexpr std::initializer_list<const char*> kOfAPart{".ply", ".wedges.json", ".wedges.corrections.json",
                                                      ".selections.json"};

/// Places of the marked.
std::vector<std::uint32_t> chosen_of(const BitMarks& marks) {
  std::vector<std::uint32_t> out;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    if (marks[k]) {
      out.push_back(static_cast<std::uint32_t>(k));
    }
  }
  return out;
}

double area_mm2(const Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  double sum = 0;
  for (const std::uint32_t f : faces) {
    const auto& [a, b, c] = mesh.faces[f];
    const Eigen::Vector3f& at = mesh.positions[a];
    sum += 0.5 * static_cast<double>((mesh.positions[b] - at).cross(mesh.positions[c] - at).norm());
  }
  return sum;
}

}  // namespace

MeshSelection ViewerScreen::selection_now() const {
  return {selection_name_, select_of_, ranges_of(selected_)};
}

void ViewerScreen::clear_selected() {
  surface_.clear_selection();
  ++selection_number_;
  selected_.clear();
  selected_mm2_ = 0;
}

/// The polygon that is closed, once the picture stands in which it was drawn; then a piece at each frame;
/// what it comes to is worked out on a thread of its own.
void ViewerScreen::go_on_selecting(UiContext& ui) {
  const TimedWork timed(ui.watch, "a selection");
  if (choosing_.valid()) {
    if (choosing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      take_chosen(choosing_.get());
    }
    return;
  }
  if (!is_current()) {
    return;  // what is marked is of another mesh, and goes with its picture
  }
  if (const MeshSelecting* selecting = surface_.selection(); selecting && selecting->is_under_way()) {
    unfinished_ = true;
    if (!surface_.select_more()) {
      choose_marked(surface_.selection()->selected());
    }
  } else if (polygon_closed_ && surface_.whole()) {
    unfinished_ = surface_.select(select_of_, polygon_, step_, !visible_only_) || unfinished_;
    drop_polygon();
  }
}

/// The first corner again closes the polygon, and so does a double click, whose first click was a corner.
void ViewerScreen::add_corner(const Eigen::Vector2f& px) {
  constexpr std::size_t kFewestCorners = 3;
  constexpr float kSamePlacePx = 8;
  if (polygon_.empty() || !(double_clicked_ || (polygon_.front() - px).norm() < kSamePlacePx)) {
    polygon_.push_back(px);
  } else {
    polygon_closed_ = polygon_.size() >= kFewestCorners;
  }
}

void ViewerScreen::drop_polygon() {
  polygon_.clear();
  polygon_closed_ = false;
}

bool ViewerScreen::selects() const {
  return polygon_closed_ || choosing_.valid() ||
         (surface_.selection() != nullptr && surface_.selection()->is_under_way());
}

void ViewerScreen::choose_marked(const SelectionMarks& marks) {
  choosing_ = std::async(std::launch::async, [marks, of = select_of_, shown = prepared_.shared(),
                                              mesh = state_.mesh, number = selection_number_] {
    Chosen out{number, marks, {}, 0};
    if (of == MeshElement::kVertex) {
      out.elements = chosen_of(*marks);
    } else {
      BitMarks is_chosen(mesh->faces.size());
      for (std::size_t k = 0; k < marks->size(); ++k) {
        if ((*marks)[k]) {
          is_chosen.mark(shown->face_of[k]);
        }
      }
      out.elements = chosen_of(is_chosen);
      out.mm2 = area_mm2(*mesh, out.elements);
    }
    wake_window();
    return out;
  });
}

/// A selection that was kept.
void ViewerScreen::show_selection(const MeshSelection& selection) {
  clear_selected();
  select_of_ = selection.of;
  selection_name_ = selection.name;
  choosing_ = std::async(std::launch::async, [selection, shown = prepared_.shared(), mesh = state_.mesh,
                                              number = selection_number_] {
    Chosen out{number, nullptr, indices_of(selection.ranges), 0};
    BitMarks chosen(selection.of == MeshElement::kVertex ? shown->positions.size() : mesh->faces.size());
    for (const std::uint32_t k : out.elements) {
      chosen.mark(k);
    }
    if (selection.of == MeshElement::kVertex) {
      out.marks = std::make_shared<const BitMarks>(std::move(chosen));
    } else {
      BitMarks marks(shown->faces.size());
      for (std::size_t k = 0; k < marks.size(); ++k) {
        if (chosen[shown->face_of[k]]) {
          marks.mark(k);
        }
      }
      out.marks = std::make_shared<const BitMarks>(std::move(marks));
      std::erase_if(out.elements, [&](std::uint32_t f) {  // what cannot be drawn has no area either
        return std::ranges::any_of(mesh->faces[f],
                                   [&](std::uint32_t v) { return v >= mesh->positions.size(); });
      });
      out.mm2 = area_mm2(*mesh, out.elements);
    }
    wake_window();
    return out;
  });
}

void ViewerScreen::take_chosen(Chosen chosen) {
  if (chosen.number != selection_number_) {
    return;  // it was cleared meanwhile, or is of another mesh
  }
  if (surface_.selection() == nullptr) {
    surface_.set_selection(select_of_, std::move(chosen.marks));
    unfinished_ = true;
  }
  selected_ = std::move(chosen.elements);
  selected_mm2_ = chosen.mm2;
}

void ViewerScreen::draw_selecting(UiContext& ui) {
  coloured_text(ui.colours.faint, ui.text(Text::kSelectHint));
  ui.facts.insert(fmt::format("corners.{}", polygon_.size()));
  const auto of = [&](const char* name, Text text, MeshElement which) {
    if (ImGui::RadioButton(ui.text(text), select_of_ == which) && select_of_ != which) {
      clear_selected();
      select_of_ = which;
    }
    ui.target(name);
  };
  if (prepared_.shown().faces.empty()) {
    select_of_ = MeshElement::kVertex;
  } else {
    of("select-faces", Text::kSelectFaces, MeshElement::kFace);
    ImGui::SameLine();
  }
  of("select-points", Text::kSelectPoints, MeshElement::kVertex);
  const auto step = [&](const char* name, Text text, SelectionStep which) {
    if (ImGui::RadioButton(ui.text(text), step_ == which)) {
      step_ = which;
    }
    ui.target(name);
  };
  step("select-union", Text::kUnion, SelectionStep::kUnion);
  ImGui::SameLine();
  step("select-intersect", Text::kIntersect, SelectionStep::kIntersection);
  ImGui::SameLine();
  step("select-subtract", Text::kSubtract, SelectionStep::kDifference);
  tick(ui, "visible-only", ui.text(Text::kVisibleOnly), visible_only_);
  if (!is_current()) {
    return;
  }
  if (!surface_.can_select(select_of_)) {
    coloured_text(ui.colours.amber, ui.text(Text::kTooManyToSelect));
    return;
  }
  if (selects()) {
    coloured_text(ui.colours.faint, "...");
  } else if (surface_.selection() != nullptr) {
    draw_selected(ui);
  }
  draw_kept_selections(ui);
}

void ViewerScreen::draw_selected(UiContext& ui) {
  ui.facts.insert(selected_.empty() ? "nothing-selected" : "selected");
  ui.facts.insert(fmt::format("selected.{}", selected_.size()));
  const std::string words = select_of_ == MeshElement::kFace
                                ? filled(ui.text(Text::kSelected), grouped(selected_.size()), selected_mm2_)
                                : filled(ui.text(Text::kSelectedPoints), grouped(selected_.size()));
  coloured_text(ui.colours.text, words.c_str());
  const ImGuiStyle& style = ImGui::GetStyle();
  const float wide = ImGui::CalcTextSize(ui.text(Text::kClear)).x + 2 * style.FramePadding.x;
  const float end = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + wide <= end) {
    ImGui::SameLine();
  }
  if (plain_button(ui, "clear-selection", ui.text(Text::kClear))) {
    clear_selected();
    return;
  }
  const bool idle = state_.stage.empty() && !selected_.empty();
  if (plain_button(ui, "keep-selection", ui.text(Text::kKeepSelection), idle)) {
    viewing_.write_part(selection_now(), unused_file("part", kOfAPart));
  }
  if (plain_button(ui, "selected-wedges", ui.text(Text::kWedgesAsTable), idle && state_.wedges)) {
    viewing_.write_wedges_of(selection_now(), unused_file("wedges", {".csv"}));
  }
  if (plain_button(ui, "analyse-part", ui.text(Text::kAnalysePart),
                   idle && select_of_ == MeshElement::kFace)) {
    viewing_.analyse_part(selection_now(), unused_file("part", kOfAPart).replace_extension());
  }
  ImGui::TextUnformatted(ui.text(Text::kSelectionName));
  ImGui::SameLine();
  short_text(ui, "selection-name", selection_name_, ui.px(6));
  ImGui::SameLine();
  if (plain_button(ui, "name-selection", ui.text(Text::kKeep), idle && !selection_name_.empty())) {
    viewing_.keep_selection(selection_now());
  }
}

void ViewerScreen::draw_kept_selections(UiContext& ui) {
  const std::vector<MeshSelection>& kept = *state_.selections;
  if (kept.empty()) {
    return;
  }
  const int lines = std::min(kMostListed, static_cast<int>(kept.size()));
  ImGui::BeginChild(
      "kept", {0, static_cast<float>(lines) * ImGui::GetTextLineHeightWithSpacing() + ui.px(0.8F)}, true);
  bool is_kept = false;
  int row = 0;
  for (const MeshSelection& selection : kept) {
    const bool chosen = selection.name == selection_name_;
    is_kept = is_kept || chosen;
    if (ImGui::Selectable(fmt::format("{}##kept", seen_line(selection.name)).c_str(), chosen) && !selects()) {
      show_selection(selection);
    }
    ui.target(fmt::format("kept.{}", ++row));
  }
  ImGui::EndChild();
  if (plain_button(ui, "forget-selection", ui.text(Text::kForget), is_kept && state_.stage.empty())) {
    viewing_.forget_selection(selection_name_);
  }
}

}  // namespace dubsar::ui
