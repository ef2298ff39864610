// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/prepared_model.h"

#include <fmt/format.h>

#include <chrono>

#include "core/log.h"
#include "ui/gl/gl_window.h"

namespace dubsar::ui {

std::unique_ptr<ReadyModel> PreparedModel::update(const LiveState& state, SurfaceView& surface) {
  if (state.mesh && state.model_number != number_ && !busy()) {
    number_ = state.model_number;
    preparing_ = std::async(std::launch::async, [mesh = state.mesh, red = state.red,
                                                 tablet_from_model = state.tablet_from_model] {
      const auto began = std::chrono::steady_clock::now();
      auto out = std::make_unique<ReadyModel>(std::make_shared<ShownMesh>(shown_mesh(*mesh)), ShownMesh(),
                                              red, tablet_from_model);
      out->few = fewest_faces(*out->whole);
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
      log_debug(fmt::format("model of {} faces made ready in {:.0f} ms, beside the window",
                            out->whole->faces.size(), 1000 * spent.count()));
      wake_window();
      return out;
    });
  }
  if (preparing_.valid() && preparing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    coming_ = preparing_.get();
    arrival_.begin(coming_->whole);
  }
  std::shared_ptr<ShownMesh> arrived = arrival_.go_on(surface);
  if (!arrived) {
    return nullptr;
  }
  coming_->whole = std::move(arrived);
  return std::move(coming_);
}

}  // namespace dubsar::ui
