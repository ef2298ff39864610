// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <future>
#include <memory>

#include "station/mesh_viewing.h"
#include "ui/shell/text_table.h"
#include "ui/view/mesh_arrival.h"

namespace dubsar::ui {

/// The mesh that is looked at, made ready for drawing on a thread of its own, then taken to the graphics card
/// piece by piece. Main thread.
class PreparedMesh {
 public:
  /// Begins where the mesh is another one. True once, when it is what `surface` shows.
  bool update(const ViewedMesh& state, SurfaceView& surface);
  [[nodiscard]] bool busy() const { return preparing_.valid() || arrival_.is_under_way(); }
  /// It goes to the graphics card, some more at each update().
  [[nodiscard]] bool arrives() const { return arrival_.is_under_way(); }
  /// What stands in shown() is the mesh of this state.
  [[nodiscard]] bool is_of(const ViewedMesh& state) const { return !busy() && number_ == state.number; }
  /// Its mesh has nothing in it.
  [[nodiscard]] bool is_empty(const ViewedMesh& state) const {
    return state.mesh && is_of(state) && state.mesh->positions.empty();
  }
  /// Why there is nothing to see.
  [[nodiscard]] Text waiting_text(const ViewedMesh& state) const {
    return is_empty(state) ? Text::kEmptyMesh : state.mesh && is_of(state) ? Text::kNoRoom : Text::kOpenMesh;
  }
  [[nodiscard]] const ShownMesh& shown() const { return *shown_; }
  [[nodiscard]] ShownMesh& shown() { return *shown_; }
  /// For other threads: of what is here only traits may change meanwhile.
  [[nodiscard]] std::shared_ptr<const ShownMesh> shared() const { return shown_; }

 private:
  std::future<std::shared_ptr<ShownMesh>> preparing_;
  MeshArrival arrival_;
  std::shared_ptr<ShownMesh> shown_ = std::make_shared<ShownMesh>();
  std::future<void> giving_back_;  ///< what was shown before
  std::uint64_t number_ = 0;
};

}  // namespace dubsar::ui
