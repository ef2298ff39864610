// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace dubsar::ui {

/// Counts how long the window kept its user waiting, and over which work. A frame belongs to the kind of work
/// that most of it went into. Main thread.
class FrameWatch {
 public:
  using Clock = std::chrono::steady_clock;

  struct Kind {
    std::size_t frames = 0;
    std::size_t slow = 0;       ///< that took longer than kSlowS
    double longest_s = 0;       ///< frame
    std::string longest_of;     ///< what the longest consisted of, and what was being done
    double longest_wait_s = 0;  ///< from an input that came when the frame before had just begun
  };
  /// What a hand still takes for at once (issue of the window: input to picture).
  static constexpr double kSlowS = 0.2;

  /// `doing`: what the user, or the script, is at.
  void begin(Clock::time_point now, std::string doing = {});
  /// The picture is on the screen.
  void end(Clock::time_point now);
  /// The frame under way did what no user asks for, such as a script's screenshot.
  void leave_out() { counted_ = false; }
  /// This frame's time so far goes to `work` until finish(); works may lie in each other, each has its own.
  void start(std::string_view work, Clock::time_point now);
  void finish(Clock::time_point now);

  [[nodiscard]] const std::map<std::string, Kind, std::less<>>& kinds() const { return kinds_; }
  /// A line for each kind of work, the longest frame first.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  struct Open {
    std::string work;
    Clock::time_point since;  ///< began, or the last work within it ended
  };
  void charge(Clock::time_point now);
  [[nodiscard]] std::string parts(double rest_s) const;

  std::map<std::string, Kind, std::less<>> kinds_;
  std::map<std::string, double, std::less<>> spent_s_;  ///< in this frame
  std::vector<Open> open_;
  std::string doing_;
  Clock::time_point began_;
  double frame_before_s_ = 0;
  bool counted_ = true;
};

/// Work of the frame under way, for as long as this stands.
class TimedWork {
 public:
  TimedWork(FrameWatch& watch, std::string_view work) : watch_(watch) {
    watch_.start(work, FrameWatch::Clock::now());
  }
  ~TimedWork() { watch_.finish(FrameWatch::Clock::now()); }
  TimedWork(const TimedWork&) = delete;
  TimedWork& operator=(const TimedWork&) = delete;

 private:
  FrameWatch& watch_;
};

}  // namespace dubsar::ui
