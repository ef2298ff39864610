// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <future>
#include <memory>

#include "station/mesh_viewing.h"
#include "ui/view/shown_mesh.h"

namespace dubsar::ui {

/// The mesh that is looked at, made ready for drawing on a thread of its own. Main thread.
class PreparedMesh {
 public:
  /// Begins where the mesh is another one. True once, when it is ready.
  bool update(const ViewedMesh& state);
  [[nodiscard]] bool busy() const { return preparing_.valid(); }
  /// What stands in shown() is the mesh of this state.
  [[nodiscard]] bool is_of(const ViewedMesh& state) const { return !busy() && number_ == state.number; }
  [[nodiscard]] const ShownMesh& shown() const { return shown_; }
  [[nodiscard]] ShownMesh& shown() { return shown_; }

 private:
  std::future<ShownMesh> preparing_;
  ShownMesh shown_;
  std::uint64_t number_ = 0;
};

}  // namespace dubsar::ui
