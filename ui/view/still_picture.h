// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/image.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// A picture of any size of a surface, drawn tile by tile beside the one that is shown, some faces of a tile
/// at each frame: the window goes on meanwhile, and no picture is too large for the graphics card. The view
/// must show the same mesh until it is done. Main thread.
class StillPicture {
 public:
  /// `camera` sees the whole picture, of that many pixels.
  StillPicture(const OrbitCamera& camera, const Look& look, int width, int height);

  /// Some more of it. True while more is to come.
  bool draw_on(SurfaceView& view);
  [[nodiscard]] double fraction() const;
  /// Once all is drawn; RGB.
  [[nodiscard]] Image take() { return std::move(image_); }

 private:
  [[nodiscard]] OrbitCamera camera_of(int tile) const;

  OrbitCamera camera_;
  Look look_;
  Image image_;
  int across_, tiles_;
  int next_ = 0;  ///< tile
  bool begun_ = false;
};

}  // namespace dubsar::ui
