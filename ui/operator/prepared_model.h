// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "station/live_state.h"
#include "ui/view/shown_mesh.h"

namespace dubsar::ui {

/// A model of the session ready to be drawn, with what belongs to it.
struct ReadyModel {
  ShownMesh whole;
  ShownMesh few;  ///< the same in as few faces as it comes, for a small picture
  std::shared_ptr<const ColouredPoints> red;
  RigidTransform tablet_from_model;
};

/// Makes the models of a session ready to be drawn, on a thread of its own, one after the other; one that is
/// outdated before its turn is left out. Main thread.
class PreparedModel {
 public:
  /// Begins where there is a new model. A model once, when it is ready.
  std::optional<ReadyModel> update(const LiveState& state);
  [[nodiscard]] bool busy() const { return preparing_.valid(); }

 private:
  std::future<ReadyModel> preparing_;
  std::uint64_t number_ = 0;
};

}  // namespace dubsar::ui
