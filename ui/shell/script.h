// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

/// One line of a script: what a person would do, or what they would wait for.
struct ScriptStep {
  enum class Kind {
    kKey,
    kClick,
    kDoubleClick,
    kDrag,
    kWheel,
    kType,
    kWait,
    kExpect,
    kScreenshot,
    kPause,
    kResize,
    kQuit
  };
  Kind kind = Kind::kQuit;
  std::string name;             ///< of a key, a target, a fact or a file; the text to type
  std::vector<double> numbers;  ///< places within the target, parts of its size; seconds to wait; a size
  bool right = false;           ///< the right mouse button
  int line = 0;
};

/// A step a line (docs/operators/window_scripts.md); '#' begins a comment. kUsage names the line.
[[nodiscard]] Result<std::vector<ScriptStep>> parse_script(std::string_view text, const std::string& where);

/// Plays a script into the window's own input, frame by frame, as if hands did it.
class ScriptPlayer {
 public:
  ScriptPlayer(std::vector<ScriptStep> steps, std::string where);

  /// Between the back end's new frame and ImGui's.
  void inject(const UiContext& ui, double now_s);
  /// After the frame was drawn. `quiet`: nothing more is being drawn. True when a screenshot is due.
  [[nodiscard]] std::optional<std::filesystem::path> screenshot_due(bool quiet);
  [[nodiscard]] bool finished() const { return next_ >= steps_.size() || failure_; }
  /// Nothing is done to the window meanwhile.
  [[nodiscard]] bool waits() const {
    return !finished() &&
           (steps_[next_].kind == ScriptStep::Kind::kWait || steps_[next_].kind == ScriptStep::Kind::kPause);
  }
  /// Line of the step that is being played.
  [[nodiscard]] std::string place() const;
  /// What a wait waited for in vain.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

 private:
  void fail_step(const std::string& what);
  void go_on();
  [[nodiscard]] bool place_of(const UiContext& ui, std::size_t first_number, ImVec2& out) const;

  std::vector<ScriptStep> steps_;
  std::string where_;
  std::size_t next_ = 0;
  int frame_ = 0;  ///< since the step began
  double began_s_ = -1;
  int quiet_frames_ = 0;
  std::optional<Error> failure_;
  ImVec2 pointer_{-1e6F, -1e6F};
};

}  // namespace dubsar::ui
