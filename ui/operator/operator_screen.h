// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "station/live_session.h"
#include "station/next_session.h"
#include "station/shown_pins.h"
#include "ui/gl/frame_target.h"
#include "ui/operator/calibration_dialog.h"
#include "ui/operator/camera_dialog.h"
#include "ui/operator/device_dialog.h"
#include "ui/operator/growing_picture.h"
#include "ui/operator/map_areas.h"
#include "ui/operator/pair_dialog.h"
#include "ui/operator/pin_dialog.h"
#include "ui/operator/pose_panel.h"
#include "ui/operator/prepared_model.h"
#include "ui/operator/statement.h"
#include "ui/shell/widgets.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

/// The operator's side of the window: one statement, the model, the scan as it grows, the six faces, the
/// scans. Main thread.
class OperatorScreen {
 public:
  explicit OperatorScreen(LiveSession& session);
  /// What stands typed of the tablet, in a line that was not left yet, is said to the session.
  ~OperatorScreen();
  OperatorScreen(const OperatorScreen&) = delete;
  OperatorScreen& operator=(const OperatorScreen&) = delete;

  /// Draws itself over the whole of the window.
  void draw(UiContext& ui, ImVec2 size);
  /// More is to be drawn though nothing happens.
  [[nodiscard]] bool unfinished() const { return unfinished_; }
  /// The model's picture is still being filled in.
  [[nodiscard]] bool draws_on() const { return draws_on_; }
  /// When the first profile came that the last frame was the first to show.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> profiles_since() const {
    return growing_.news_since();
  }
  /// Of the window: which tablet, which session, which scanner.
  [[nodiscard]] std::string title() const;
  /// Labelled pins and places on the rim, where the registered scans show them.
  [[nodiscard]] std::vector<ShownPin> pins_on_model() const;
  /// The session of the next tablet is wanted in place of this one; cleared by asking.
  [[nodiscard]] std::optional<std::filesystem::path> wants_session() {
    return std::exchange(next_session_, std::nullopt);
  }
  /// The operator wants to look at the model; cleared by asking.
  [[nodiscard]] bool wants_viewer() { return std::exchange(wants_viewer_, false); }

 private:
  void take_state(UiContext& ui);
  void sound_out(const UiContext& ui);
  // statement_band.cpp
  [[nodiscard]] static float statement_high_px(const UiContext& ui, const Statement& statement, ImVec2 room);
  void draw_statement(UiContext& ui, const Statement& statement, ImVec2 size);
  void draw_last_action(UiContext& ui, const Statement& statement, ImVec2 button);
  // side_columns.cpp
  void draw_face(UiContext& ui, Face which, const FaceState& face, Text name);
  void draw_faces(UiContext& ui);
  void draw_unplaced(UiContext& ui);
  void draw_session_line(UiContext& ui);
  void draw_left(UiContext& ui, ImVec2 size);
  void draw_model(UiContext& ui, ImVec2 size, bool asks_for_places);
  void draw_halt(UiContext& ui, ImVec2 model_end);
  void draw_right(UiContext& ui, ImVec2 size);
  void draw_growing(UiContext& ui, ImVec2 size);
  void draw_strip(UiContext& ui, ImVec2 size);
  void draw_scan_menu(UiContext& ui, const LiveScan& scan);
  void draw_settings(UiContext& ui);
  void draw_tablet(UiContext& ui);
  /// Where it is another than was said last, or `anyway`.
  void say_record(bool anyway);
  /// What a box is for, and of which tablet: its number, or where it is kept.
  [[nodiscard]] std::string title_of(const UiContext& ui, Text what) const;
  void draw_excused(UiContext& ui);
  void draw_signing(UiContext& ui);
  void draw_package(UiContext& ui);
  void draw_next(UiContext& ui);
  void act(const Statement& statement, const UiContext& ui);
  void look_at(Face face);
  void fit_model();
  void open_pairs();
  void undo();
  void open_signing(const UiContext& ui);
  void open_package();
  void open_next();
  /// Nothing is under way that the next tablet would end.
  [[nodiscard]] bool may_leave() const { return !session_.is_occupied() && !state_.scans.empty(); }

  LiveSession& session_;
  LiveState state_;
  SurfaceView model_;
  OrbitCamera camera_;
  bool camera_set_ = false;
  float model_aspect_ = 1;  ///< of the place that the model is fitted to
  bool is_fitted_ = false;  ///< it was not turned, moved or brought nearer since
  Eigen::AlignedBox3f model_box_mm_;
  std::optional<Face> looked_at_;  ///< until the model is turned otherwise
  PreparedModel prepared_;
  std::future<void> giving_back_;  ///< of the last one
  bool model_has_red_ = false;     ///< points; else the mesh itself says what is sparse
  PosePanel pose_;
  PairDialog pairs_;
  PinDialog pins_;
  DeviceDialog devices_;
  CameraDialog camera_box_;
  CalibrationDialog calibration_;
  GrowingPicture growing_;
  struct Thumbnail {
    PixelTexture texture;
    std::shared_ptr<const GridPicture> of;
    bool blue = false;
  };
  std::map<int, Thumbnail> thumbnails_;
  int chosen_ = -1;  ///< scan
  TabletRecord record_;
  TabletRecord said_record_;  ///< to the session
  bool record_taken_ = false;
  bool types_record_ = false;  ///< in a line that is not left yet
  std::string sign_name_, sign_role_, sign_incomplete_;
  bool sign_too_early_ = false;  ///< enter was pressed while a line lacked
  std::string package_folder_, next_folder_;
  std::string next_asked_for_;              ///< the folder that next_found_ lies in
  std::optional<FoundSession> next_found_;  ///< asked about before it is gone on with
  std::optional<std::filesystem::path> next_session_;
  bool open_sign_ = false, open_tablet_ = false, open_settings_ = false;
  bool open_package_ = false, open_next_ = false;
  bool wants_viewer_ = false;
  bool unfinished_ = false;
  bool draws_on_ = false;
  LivePhase heard_phase_ = LivePhase::kStill;  ///< as of the last frame
  TimeLeft time_left_;
  std::size_t strip_scans_ = 0;
};

/// A grid picture in colour, RGB.
[[nodiscard]] std::vector<unsigned char> coloured(const GridPicture& picture, const UiContext& ui);

}  // namespace dubsar::ui
