// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/mesh_arrival.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "core/log.h"
#include "ui/gl/gl_window.h"

namespace dubsar::ui {

std::shared_ptr<ShownMesh> MeshArrival::go_on(SurfaceView& view) {
  if (fewer_.valid()) {
    if (fewer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
      return nullptr;
    }
    mesh_ = fewer_.get();
  }
  if (!mesh_) {
    return nullptr;
  }
  const Arrival arrival = view.show_soon(*mesh_);
  if (arrival == Arrival::kUnderWay) {
    return nullptr;
  }
  if (arrival == Arrival::kRefused) {
    log_warning(fmt::format("the graphics card has no room for {} faces and {} vertices{}",
                            mesh_->faces.size(), mesh_->positions.size(),
                            mesh_->coarser.empty() ? "" : ": fewer are shown"));
    if (!mesh_->coarser.empty()) {
      fewer_ = std::async(std::launch::async, [mesh = mesh_] {
        auto fewer = std::make_shared<ShownMesh>(in_fewer_faces(*mesh, mesh->coarser.size() - 1));
        wake_window();
        return fewer;
      });
      return nullptr;
    }
  }
  return std::exchange(mesh_, nullptr);
}

}  // namespace dubsar::ui
