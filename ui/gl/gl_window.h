// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <string>

#include "core/result.h"

struct GLFWwindow;

namespace dubsar::ui {

/// The window and its OpenGL 4.1 core context; closes both when it goes. Use from the main thread. One at a
/// time.
class GlWindow {
 public:
  /// kDevice, with what was found, without a display or without OpenGL 4.1.
  [[nodiscard]] static Result<GlWindow> open(int width, int height, const std::string& title);
  ~GlWindow();
  GlWindow(GlWindow&& other) noexcept;
  GlWindow& operator=(GlWindow&&) = delete;

  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  /// How many times as large as usual its display is set to show things (2 on many of 3840 x 2160 pixels).
  [[nodiscard]] float content_scale() const;

 private:
  GlWindow(GLFWwindow* window, std::string renderer);
  GLFWwindow* window_ = nullptr;
  std::string renderer_;
};

/// Wakes the main thread where it waits for input; from any thread.
void wake_window();

}  // namespace dubsar::ui
