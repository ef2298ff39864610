// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <future>
#include <memory>

#include "ui/view/shown_mesh.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// A mesh on its way to a view, piece by piece. Where the graphics card has no room for it, it comes in fewer
/// faces, in the finest level of detail for which there is room. Main thread.
class MeshArrival {
 public:
  /// None must be under way.
  void begin(std::shared_ptr<ShownMesh> mesh) { mesh_ = std::move(mesh); }
  [[nodiscard]] bool is_under_way() const { return mesh_ != nullptr; }
  /// Some more of it. What `view` shows, once it does; until then null. Where there is no room for any level
  /// the view is left empty.
  std::shared_ptr<ShownMesh> go_on(SurfaceView& view);

 private:
  std::shared_ptr<ShownMesh> mesh_;
  std::future<std::shared_ptr<ShownMesh>> fewer_;  ///< is being made
};

}  // namespace dubsar::ui
