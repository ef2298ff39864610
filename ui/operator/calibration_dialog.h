// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "core/result.h"
#include "station/calibration_run.h"
#include "station/live_session.h"
#include "ui/gl/frame_target.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// The daily measurement of the artefact, and the calibration of a camera, its laser and its stage, step by
/// step: `dubsar calibrate` in a box.
class CalibrationDialog {
 public:
  explicit CalibrationDialog(LiveSession& session) : session_(session) {}
  void open();
  void draw(UiContext& ui, const LiveState& state);

 private:
  void draw_verify(UiContext& ui, const LiveState& state);
  void draw_calibrate(UiContext& ui, const LiveState& state);
  void draw_stage(UiContext& ui);
  void draw_shots(UiContext& ui);
  void take_shot();
  void draw_action(UiContext& ui, const LiveState& state);
  void draw_camera(UiContext& ui, ImVec2 size);
  LiveSession& session_;
  std::string device_;  ///< when it was opened last
  VerifyRequest verify_;
  CalibrateRequest calibrate_;
  std::string out_;
  MotionKind motion_ = MotionKind::kLinear;
  std::string position_ = "0";
  std::string temperature_;  ///< °C; may be empty
  struct Shot {
    CalibrationShot shot = CalibrationShot::kBoard;
    CalibrationWords words;
    double position = 0;
    std::string folder;
  };
  std::optional<Shot> wanted_;  ///< that waits for a frame in its light
  std::future<Result<std::string>> shooting_;
  std::string shot_said_;
  bool shot_failed_ = false;
  bool verifying_ = true;  ///< the first of the two pages
  PixelTexture texture_;
  std::shared_ptr<const CameraView> shown_;
  TimeLeft time_left_;
  bool opening_ = false;
  bool open_ = false;
};

/// When the rig was last measured, and whether that is good enough for today: one line.
[[nodiscard]] std::string care_line(const RigCare& care, Language language);

}  // namespace dubsar::ui
