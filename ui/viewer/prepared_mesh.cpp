// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/viewer/prepared_mesh.h"

#include <chrono>
#include <utility>

#include "ui/gl/gl_window.h"
#include "ui/shell/give_back.h"

namespace dubsar::ui {

bool PreparedMesh::update(const ViewedMesh& state, SurfaceView& surface) {
  if (state.mesh && state.number != number_ && !busy()) {
    number_ = state.number;
    preparing_ = std::async(std::launch::async, [mesh = state.mesh] {
      auto shown = std::make_shared<ShownMesh>(shown_mesh(*mesh));
      wake_window();
      return shown;
    });
  }
  if (preparing_.valid() && preparing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    arrival_.begin(preparing_.get());
  }
  std::shared_ptr<ShownMesh> arrived = arrival_.go_on(surface);
  if (!arrived) {
    return false;
  }
  giving_back_ = give_back(std::exchange(shown_, std::move(arrived)));
  return true;
}

}  // namespace dubsar::ui
