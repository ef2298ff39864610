// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/viewer/prepared_mesh.h"

#include <chrono>

#include "ui/gl/gl_window.h"

namespace dubsar::ui {

bool PreparedMesh::update(const ViewedMesh& state) {
  if (state.mesh && state.number != number_ && !preparing_.valid()) {
    number_ = state.number;
    preparing_ = std::async(std::launch::async, [mesh = state.mesh] {
      ShownMesh shown = shown_mesh(*mesh);
      wake_window();
      return shown;
    });
  }
  if (!preparing_.valid() || preparing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return false;
  }
  shown_ = preparing_.get();
  return true;
}

}  // namespace dubsar::ui
