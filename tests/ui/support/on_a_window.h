// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include "tests/ui/support/card_context.h"
#include "tests/ui/support/display.h"
#include "ui/gl/gl_window.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// A test with an OpenGL window on a display of its own, drawn by the processor, and a view to draw meshes
/// in; fails where there is no Xvfb. With DUBSAR_TEST_CARD set, on a graphics card and without a display.
class OnAWindow : public ::testing::Test {
 protected:
  void SetUp() final {
    if (std::getenv("DUBSAR_TEST_CARD") != nullptr) {
      Result<test::CardContext> card = test::CardContext::open();
      ASSERT_TRUE(card) << card.error().line();
      card_.emplace(std::move(*card));
    } else {
      display_.emplace();
      ASSERT_TRUE(display_->works()) << "there is no Xvfb here: install xvfb (packages.txt)";
      Result<GlWindow> window = GlWindow::open(64, 64, "test");
      ASSERT_TRUE(window) << window.error().line();
      window_.emplace(std::move(*window));
    }
    view_ = std::make_unique<SurfaceView>();
    show();
  }
  /// What all tests of a suite look at.
  virtual void show() = 0;

  std::optional<test::CardContext> card_;
  std::optional<test::Display> display_;
  std::optional<GlWindow> window_;
  std::unique_ptr<SurfaceView> view_;
};

}  // namespace dubsar::ui
