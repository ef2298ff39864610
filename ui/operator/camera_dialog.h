// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "station/live_session.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// What the camera sees now, what is wrong with its exposure, and the settings of the device that is open.
class CameraDialog {
 public:
  explicit CameraDialog(LiveSession& session) : session_(session) {}
  void open() { opening_ = true; }
  void draw(UiContext& ui, const LiveState& state);

 private:
  void draw_view(UiContext& ui, ImVec2 size);
  void draw_settings(UiContext& ui, const DevicePanel& panel);
  void take_panel(std::shared_ptr<const DevicePanel> panel);
  LiveSession& session_;
  PixelTexture texture_;
  std::shared_ptr<const CameraView> shown_;
  std::shared_ptr<const DevicePanel> panel_;  ///< that `typed_` was taken from
  std::map<std::string, std::string> typed_;  ///< by setting
  std::set<std::string> put_;                 ///< since the device told its settings
  std::string old_notice_;                    ///< said before the box was opened: of something else
  bool opening_ = false;
  bool open_ = false;
};

/// A frame in colour, RGB: what is saturated is hatched in orange, rising; what is too dark in blue, falling.
/// The two are told apart by direction and by colours that the colour-blind see (Okabe and Ito 2008).
[[nodiscard]] std::vector<unsigned char> hatched(const CameraView& view);

/// One line: whether the exposure is good, and by what figure.
[[nodiscard]] std::string exposure_line(const Exposure& exposure, Language language);

}  // namespace dubsar::ui
