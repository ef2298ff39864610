// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "station/live_session.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// The scan under way as a picture on the graphics card, to which only the rows go that have come or changed
/// since the last frame. Main thread.
class GrowingPicture {
 public:
  void update(LiveSession& session, const UiContext& ui);
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return texture_.width(); }
  [[nodiscard]] unsigned texture() const { return texture_.id(); }
  /// Part of the texture's height that has rows in it.
  [[nodiscard]] float filled() const {
    return static_cast<float>(rows_) / static_cast<float>(texture_.height());
  }
  /// When the first profile came that this frame is the first to show.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> news_since() const { return since_; }

 private:
  PixelTexture texture_;
  std::vector<unsigned char> pixels_;  ///< [texture height * cols * 3]
  std::uint64_t scan_ = 0;
  int rows_ = 0;
  bool dark_ = false, blue_ = false;  ///< colours that it was painted in
  std::optional<std::chrono::steady_clock::time_point> since_;
};

}  // namespace dubsar::ui
