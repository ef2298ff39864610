// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>

#include "tests/ui/support/display.h"
#include "ui/gl/gl_window.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// A test with an OpenGL window on a display of its own, and a view to draw meshes in; fails where there is
/// no Xvfb.
class OnAWindow : public ::testing::Test {
 protected:
  void SetUp() final {
    if (!display_.works()) {
      FAIL() << "there is no Xvfb here: install xvfb (packages.txt)";
    }
    Result<GlWindow> window = GlWindow::open(64, 64, "test");
    ASSERT_TRUE(window) << window.error().line();
    window_.emplace(std::move(*window));
    view_ = std::make_unique<SurfaceView>();
    show();
  }
  /// What all tests of a suite look at.
  virtual void show() = 0;

  test::Display display_;
  std::optional<GlWindow> window_;
  std::unique_ptr<SurfaceView> view_;
};

}  // namespace dubsar::ui
