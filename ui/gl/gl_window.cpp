// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/gl/gl_window.h"

#include <epoxy/gl.h>
// epoxy first: it refuses to come after another OpenGL header.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <atomic>
#include <utility>

namespace dubsar::ui {

namespace {

constexpr int kMajor = 4;
constexpr int kMinor = 1;
constexpr const char* kMend =
    "use a display with OpenGL 4.1 (on a machine without a graphics card: LIBGL_ALWAYS_SOFTWARE=1), or the "
    "command line, which does everything";

std::string last_complaint;        // of GLFW; main thread only
std::atomic<bool> is_open{false};  // wake_window() comes from threads that may outlive the window

void hear_complaint(int /*code*/, const char* what) {
  last_complaint = what != nullptr ? what : "";
}

/// What an older context is called, for the one line that refuses it.
std::string what_there_is() {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* probe = glfwCreateWindow(16, 16, "", nullptr, nullptr);
  if (probe == nullptr) {
    return "no OpenGL at all";
  }
  glfwMakeContextCurrent(probe);
  const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  std::string found = std::string("OpenGL ") + (version != nullptr ? version : "of unknown version") + " (" +
                      (renderer != nullptr ? renderer : "unknown") + ")";
  glfwDestroyWindow(probe);
  return found;
}

}  // namespace

Result<GlWindow> GlWindow::open(int width, int height, const std::string& title) {
  glfwSetErrorCallback(hear_complaint);
  if (glfwInit() == GLFW_FALSE) {
    return fail(ErrorKind::kDevice, "no window can be opened: " + last_complaint, "display", kMend);
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, kMajor);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, kMinor);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string found = what_there_is();
    glfwTerminate();
    return fail(ErrorKind::kDevice, "the window needs OpenGL 4.1, and there is " + found, "display", kMend);
  }
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  is_open = true;
  return GlWindow(window, renderer != nullptr ? renderer : "");
}

GlWindow::GlWindow(GLFWwindow* window, std::string renderer)
    : window_(window), renderer_(std::move(renderer)) {}

GlWindow::GlWindow(GlWindow&& other) noexcept
    : window_(std::exchange(other.window_, nullptr)), renderer_(std::move(other.renderer_)) {}

GlWindow::~GlWindow() {
  if (window_ != nullptr) {
    is_open = false;
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
}

float GlWindow::content_scale() const {
  float x = 1;
  float y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::min(x, y);
}

void wake_window() {
  if (is_open) {
    glfwPostEmptyEvent();
  }
}

}  // namespace dubsar::ui
