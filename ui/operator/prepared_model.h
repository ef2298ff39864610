// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <future>
#include <memory>

#include "station/live_state.h"
#include "ui/view/mesh_arrival.h"

namespace dubsar::ui {

/// A model of the session ready to be drawn, with what belongs to it.
struct ReadyModel {
  std::shared_ptr<ShownMesh> whole;
  ShownMesh few;  ///< the same in as few faces as it comes, for a small picture
  std::shared_ptr<const ColouredPoints> red;
  RigidTransform tablet_from_model;
};

/// Makes the models of a session ready to be drawn, on a thread of its own, then takes them to the graphics
/// card piece by piece, one after the other; one that is outdated before its turn is left out. Main thread.
class PreparedModel {
 public:
  /// Begins where there is a new model. A model once, when it is what `surface` shows; else null.
  std::unique_ptr<ReadyModel> update(const LiveState& state, SurfaceView& surface);
  [[nodiscard]] bool busy() const { return preparing_.valid() || arrives(); }
  /// One goes to the graphics card, some more at each update().
  [[nodiscard]] bool arrives() const { return arrival_.is_under_way(); }

 private:
  std::future<std::unique_ptr<ReadyModel>> preparing_;
  std::unique_ptr<ReadyModel> coming_;
  MeshArrival arrival_;  ///< of its mesh
  std::uint64_t number_ = 0;
};

}  // namespace dubsar::ui
