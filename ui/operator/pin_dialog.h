// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "station/live_state.h"
#include "station/operator_command.h"
#include "station/shown_pins.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

inline constexpr int kPinNumbers = 15;
inline constexpr int kRimPlaces = 6;

/// Says which pin is which: the operator clicks the tips of the pins, and places on the rim that they know
/// again, in two scans beside each other (seed 001, 3.2).
class PinDialog {
 public:
  void open(const LiveScan& scan, const LiveState& state);
  /// What was labelled anew, a command for each scan, in the frame in which it was given.
  std::vector<LabelPins> draw(UiContext& ui);

 private:
  struct Mark {
    ImVec2 place;                ///< parts of the picture
    Eigen::Vector3d surface_mm;  ///< scanner frame: what was clicked
  };
  struct Side {
    LiveScan scan;
    GridPicture picture;  ///< pins and all
    PixelTexture texture;
    std::map<int, Mark> marks;  ///< by label
    bool changed = false;
    bool drawn = false;  ///< the texture is that of the picture
  };
  void take(Side& side, const LiveScan& scan);
  void draw_labels(UiContext& ui);
  void draw_side(UiContext& ui, const char* name, Side& side, ImVec2 size);
  void draw_panes(UiContext& ui, float foot_px);
  [[nodiscard]] std::vector<LabelPins> said(double diameter_mm) const;

  std::shared_ptr<const PinSet> pins_;
  std::vector<LiveScan> others_;
  Side left_, right_;
  int label_ = 1;  ///< that the next click gives
  std::string diameter_;
  bool opening_ = false;
};

}  // namespace dubsar::ui
