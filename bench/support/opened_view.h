// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <memory>

#include "core/mesh.h"
#include "ui/view/surface_view.h"

namespace dubsar::bench {

/// The picture that viewers are timed at.
inline constexpr int kWidth = 1920;
inline constexpr int kHeight = 1200;

/// A mesh in the viewer's own view, the tablet's front towards it.
struct OpenedView {
  ui::ShownMesh shown;
  std::unique_ptr<ui::SurfaceView> view;
  ui::OrbitCamera camera;
};

/// Prints a step that began then and has just ended; its seconds.
double told(const char* what, std::chrono::steady_clock::time_point began);

/// Makes it ready and shows it until every face is drawn, and prints what each step took; `read_s` went
/// before.
[[nodiscard]] OpenedView open_view(const Mesh& mesh, double read_s);

}  // namespace dubsar::bench
