// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <mutex>
#include <thread>

#include "acquisition/position_track.h"
#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// Asks a stage that moves where it is, again and again, on a thread of its own, until it stands still. While
/// one of these lives nobody else uses the stage but for stop().
class StageWatch {
 public:
  /// A stage that moves for longer than `at_most` is one that failed: its motor is stuck, or it lies.
  StageWatch(const Device& stage, std::size_t axis, std::chrono::milliseconds at_most);
  ~StageWatch();
  StageWatch(const StageWatch&) = delete;
  StageWatch& operator=(const StageWatch&) = delete;

  [[nodiscard]] PositionTrack& track() { return track_; }
  /// Ends the questions, if the stage still moves; then why the stage told no more, if it failed.
  [[nodiscard]] Status finish();

 private:
  void ask(const std::stop_token& enough);

  const Device& stage_;
  std::size_t axis_;
  std::chrono::steady_clock::time_point until_;
  PositionTrack track_;
  std::mutex mutex_;
  Status status_;
  std::jthread thread_;
};

}  // namespace dubsar
