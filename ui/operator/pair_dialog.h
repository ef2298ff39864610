// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "station/live_state.h"
#include "station/operator_command.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// Says where an unsure scan lies: the operator clicks the same places in it and in a scan that fits.
class PairDialog {
 public:
  void open(const LiveScan& unsure, const std::vector<LiveScan>& scans);
  [[nodiscard]] bool is_open() const { return unsure_.grid != nullptr; }
  /// The hint, in the frame in which it was given.
  std::optional<HintScan> draw(UiContext& ui);

 private:
  struct Side {
    PixelTexture texture;
    std::vector<Eigen::Vector3d> points_mm;  ///< scanner frame
    std::vector<ImVec2> places;              ///< parts of the picture
  };
  void draw_side(UiContext& ui, const char* name, const LiveScan& scan, Side& side, bool expects,
                 ImVec2 size);
  void choose(std::size_t other);
  LiveScan unsure_;
  std::vector<LiveScan> others_;  ///< registered
  std::size_t other_ = 0;
  Side left_, right_;
  bool opening_ = false;
  bool textures_old_ = true;
};

}  // namespace dubsar::ui
