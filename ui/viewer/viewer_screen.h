// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <future>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "archive/colour_legend.h"
#include "core/red_map.h"
#include "core/result.h"
#include "station/mesh_viewing.h"
#include "station/shown_pins.h"
#include "station/wedge_histogram.h"
#include "ui/shell/widgets.h"
#include "ui/view/still_picture.h"
#include "ui/view/surface_view.h"
#include "ui/viewer/prepared_mesh.h"

namespace dubsar::ui {

/// The scholar's side of the window: a mesh as if it lay under a lamp, what is known of each place, its
/// wedges. Main thread.
class ViewerScreen {
 public:
  /// `pictures` is where pictures are kept.
  ViewerScreen(MeshViewing& viewing, std::filesystem::path pictures, bool has_session);

  void draw(UiContext& ui, ImVec2 size);
  [[nodiscard]] bool unfinished() const { return unfinished_; }
  /// Of the mesh that is shown next.
  void show_pins(std::vector<ShownPin> pins) { pins_ = std::move(pins); }
  [[nodiscard]] bool wants_scanning() { return std::exchange(wants_scanning_, false); }

 private:
  enum class Tool { kTurn, kMeasure, kSection, kSelect, kCorrect };
  void take_state(UiContext& ui);
  void draw_panel(UiContext& ui, ImVec2 size);
  void draw_light(UiContext& ui);
  void draw_overlay_choice(UiContext& ui);
  void draw_facts(UiContext& ui);
  void draw_foot(UiContext& ui);
  void draw_surface(UiContext& ui, ImVec2 size);
  void use_pointer(ImVec2 origin, ImVec2 size);
  void drop_what_is_of_another_view(ImVec2 size);
  void draw_wedges(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  void draw_tape(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  // viewer_section.cpp
  void cut_between_places();
  void draw_section_panel(UiContext& ui);
  void draw_section(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  void draw_polygon(UiContext& ui, ImVec2 origin) const;
  // viewer_selecting.cpp
  struct Chosen {
    std::uint64_t number = 0;  ///< selection_number_ when it was asked for
    SelectionMarks marks;
    std::vector<std::uint32_t> elements;  ///< as selected_
    double mm2 = 0;
  };
  void go_on_selecting(UiContext& ui);
  void add_corner(const Eigen::Vector2f& px);
  void drop_polygon();
  [[nodiscard]] bool selects() const;
  void choose_marked(const SelectionMarks& marks);
  void take_chosen(Chosen chosen);
  void show_selection(const MeshSelection& selection);
  void clear_selected();
  void draw_selecting(UiContext& ui);
  void draw_selected(UiContext& ui);
  void draw_kept_selections(UiContext& ui);
  [[nodiscard]] MeshSelection selection_now() const;
  void draw_legend(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  void draw_flags_legend(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  void draw_histogram(UiContext& ui);
  void draw_wedge_table(UiContext& ui, ImVec2 size, bool with_length);
  void look_at(Face face);
  void choose(int wedge, bool go_there);
  // viewer_picture.cpp
  void begin_picture(const UiContext& ui);
  /// Of a picture of what is shown; nothing where its colours are the clay's, or of its own.
  [[nodiscard]] std::optional<ColourLegend> picture_legend() const;
  void give_up_picture();
  void draw_picture_on(UiContext& ui);
  void draw_picture_foot(UiContext& ui);
  // viewer_correcting.cpp
  void draw_correcting(UiContext& ui);
  void draw_split_places(UiContext& ui, ImVec2 origin, ImVec2 size) const;
  void mark(int wedge);
  [[nodiscard]] std::vector<Eigen::Vector3d> marked_places() const;
  void draw_tools(UiContext& ui);
  /// What is drawn is the mesh of state_.
  [[nodiscard]] bool is_current() const { return !surface_.empty() && prepared_.is_of(state_); }
  /// NAME_WHAT_01 of the pictures' folder with the first of the endings; the first number under which none of
  /// them is there.
  [[nodiscard]] std::filesystem::path unused_file(const std::string& what,
                                                  std::initializer_list<const char*> endings);
  [[nodiscard]] int wedge_at(const Eigen::Vector2f& px, ImVec2 size) const;
  /// What is clicked on the surface is a place on it.
  [[nodiscard]] bool takes_places() const;
  void take_places(UiContext& ui);

  MeshViewing& viewing_;
  std::filesystem::path pictures_;
  bool has_session_;
  ViewedMesh state_;
  SurfaceView surface_;
  OrbitCamera camera_;
  Look look_;
  PreparedMesh prepared_;
  bool openness_due_ = false;  ///< to be asked for once the mesh has been seen
  std::shared_ptr<const std::vector<float>> shown_openness_, shown_values_;
  std::optional<MeshField> field_;  ///< that the overlay shows, or will as soon as it is known
  Tool tool_ = Tool::kTurn;
  std::vector<Eigen::Vector2f> clicked_px_;  ///< places that are read off once the whole surface stands there
  std::vector<Eigen::Vector3f> tape_;        ///< up to two places
  std::vector<Eigen::Vector2f> polygon_;     ///< corners so far, pixels of the picture
  OrbitCamera clicked_camera_;               ///< of these clicks and corners, and the picture's size
  ImVec2 clicked_size_;
  SelectionStep step_ = SelectionStep::kUnion;
  bool visible_only_ = true;
  MeshElement select_of_ = MeshElement::kFace;
  bool polygon_closed_ = false;  ///< and is to be taken up
  std::future<Chosen> choosing_;
  std::uint64_t selection_number_ = 0;   ///< grows when it is cleared
  std::vector<std::uint32_t> selected_;  ///< faces or vertices of the mesh, rising
  double selected_mm2_ = 0;              ///< of faces
  std::string selection_name_;
  std::set<std::filesystem::path> handed_out_;  ///< names of files that are perhaps not written yet
  std::filesystem::path section_file_;          ///< that was asked for last
  std::vector<std::filesystem::path> seen_written_;
  std::shared_ptr<const std::vector<Wedge>> seen_wedges_;
  std::vector<int> marked_;  ///< wedges that a correction is about, as in the table
  bool splitting_ = false;   ///< clicks are places of new wedges
  std::vector<Eigen::Vector3f> split_places_;
  int wedge_ = -1;
  std::size_t histogram_feature_ = 0;  ///< of kWedgeFeatures
  std::shared_ptr<const std::vector<Wedge>> histogram_wedges_;
  WedgeHistogram histogram_;  ///< of these two
  bool scroll_to_wedge_ = false;
  bool show_wedges_ = true;
  std::vector<ShownPin> pins_;  ///< of the session's model
  bool show_pins_ = true;
  bool dragged_ = false;
  bool double_clicked_ = false;  ///< the click that is under way is the second of two
  bool untouched_ = true;        ///< the view is still as it was set up
  Face looked_at_ = Face::kObverse;
  float aspect_ = 1.5F;
  int dpi_ = 600;
  std::optional<StillPicture> still_;  ///< that is being drawn
  double still_mm_per_px_ = 0;
  std::optional<ColourLegend> still_legend_;
  std::filesystem::path still_file_;
  std::future<Status> writing_;
  bool picture_kept_ = false;
  std::string picture_note_;
  TimeLeft time_left_, picture_time_left_;
  float foot_px_ = 0;  ///< of the panel, as it was drawn last
  bool unfinished_ = false;
  bool wants_scanning_ = false;
};

/// From the 2nd to the 98th percentile, so that strays do not eat the colours; symmetric about 0 where the
/// numbers have both signs.
[[nodiscard]] Eigen::Vector2f shown_range(const std::vector<float>& values);

}  // namespace dubsar::ui
