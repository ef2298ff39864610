// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/ui/support/card_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace dubsar::test {

namespace {

bool is_processor(EGLDeviceEXT device) {
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return extensions != nullptr &&
         std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
}

/// Graphics cards first.
std::vector<EGLDeviceEXT> devices() {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
    return {};
  }
  EGLint count = 0;
  if (eglQueryDevicesEXT(0, nullptr, &count) == EGL_FALSE) {
    return {};
  }
  std::vector<EGLDeviceEXT> found(static_cast<std::size_t>(count));
  if (eglQueryDevicesEXT(count, found.data(), &count) == EGL_FALSE) {
    return {};
  }
  std::ranges::stable_partition(found, [](EGLDeviceEXT device) { return !is_processor(device); });
  return found;
}

/// No context where the display has no OpenGL 4.1.
EGLContext context_of(EGLDisplay display) {
  if (eglInitialize(display, nullptr, nullptr) == EGL_FALSE || eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    return EGL_NO_CONTEXT;
  }
  constexpr std::array<EGLint, 5> kWanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                          EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglChooseConfig(display, kWanted.data(), &config, 1, &configs) == EGL_FALSE || configs == 0) {
    return EGL_NO_CONTEXT;
  }
  constexpr std::array<EGLint, 7> kVersion{EGL_CONTEXT_MAJOR_VERSION,
                                           4,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           1,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, kVersion.data());
  if (context == EGL_NO_CONTEXT) {
    return EGL_NO_CONTEXT;
  }
  constexpr std::array<EGLint, 5> kSize{EGL_WIDTH, 64, EGL_HEIGHT, 64, EGL_NONE};
  EGLSurface surface = eglCreatePbufferSurface(display, config, kSize.data());
  if (surface == EGL_NO_SURFACE || eglMakeCurrent(display, surface, surface, context) == EGL_FALSE) {
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
  }
  return context;
}

}  // namespace

Result<CardContext> CardContext::open() {
  const std::vector<EGLDeviceEXT> found = devices();
  for (EGLDeviceEXT device : found) {
    EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    if (display == EGL_NO_DISPLAY) {
      continue;
    }
    if (EGLContext context = context_of(display); context != EGL_NO_CONTEXT) {
      CardContext out(display, context);
      out.renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
      return out;
    }
    eglTerminate(display);
  }
  return fail(ErrorKind::kDevice,
              "none of " + std::to_string(found.size()) + " EGL devices has OpenGL 4.1 without a display",
              "card", "leave --card out: a display, or one made for it, is used then");
}

CardContext::CardContext(CardContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)),
      renderer_(std::move(other.renderer_)) {}

CardContext::~CardContext() {
  if (display_ != nullptr) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
}

}  // namespace dubsar::test
