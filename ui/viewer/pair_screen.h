// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "station/mesh_viewing.h"
#include "ui/shell/widgets.h"
#include "ui/view/surface_view.h"
#include "ui/viewer/prepared_mesh.h"

namespace dubsar::ui {

/// Two meshes side by side, to one scale under one light, turned together or each by itself. Main thread.
class PairScreen {
 public:
  PairScreen(MeshViewing& left, MeshViewing& right);

  void draw(UiContext& ui, ImVec2 size);
  [[nodiscard]] bool unfinished() const { return unfinished_; }

 private:
  struct Pane {
    MeshViewing* viewing = nullptr;
    bool openness_due = false;  ///< to be asked for once the mesh has been seen
    ViewedMesh state;
    PreparedMesh prepared;
    SurfaceView surface;
    std::shared_ptr<const std::vector<float>> openness;
    OrbitCamera camera;
    bool dragged = false;
  };
  void take_state(UiContext& ui, Pane& pane);
  void draw_bar(UiContext& ui);
  void draw_pane(UiContext& ui, Pane& pane, const char* name, ImVec2 size);
  void look_at(Face face);
  void follow(const OrbitCamera& before, const Pane& moved, Pane& other) const;

  std::array<Pane, 2> panes_;
  Look look_;
  bool together_ = true;
  Face face_ = Face::kObverse;  ///< that was asked for last
  bool untouched_ = true;       ///< both are still as they were set up
  float aspect_ = 1;
  bool unfinished_ = false;
};

}  // namespace dubsar::ui
