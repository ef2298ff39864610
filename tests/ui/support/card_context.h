// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/result.h"

namespace dubsar::test {

/// OpenGL 4.1 without a display, through EGL: on the first graphics card that has it, else drawn by the
/// processor. Current until it goes; one at a time, main thread.
class CardContext {
 public:
  /// kDevice, with what was found.
  [[nodiscard]] static Result<CardContext> open();
  ~CardContext();
  CardContext(CardContext&& other) noexcept;
  CardContext& operator=(CardContext&&) = delete;
  [[nodiscard]] const std::string& renderer() const { return renderer_; }

 private:
  CardContext(void* display, void* context) : display_(display), context_(context) {}
  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string renderer_;
};

}  // namespace dubsar::test
