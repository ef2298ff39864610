// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <linux/videodev2.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace dubsar::test {

/// What a camera driver of the kernel does: answers V4L2 ioctls, fills queued buffers at its rate, and has
/// bad days on request. Knows nothing of how the calls reach it.
class VirtualCamera {
 public:
  struct Mode {
    std::uint32_t fourcc, width, height, rate_hz;
  };
  static constexpr int kNotYet = -100000;  ///< of control(): DQBUF has nothing

  VirtualCamera(std::string card, std::vector<Mode> modes);

  /// Bytes between the buffers in what is mapped, and all of it.
  [[nodiscard]] std::uint64_t buffer_stride() const { return stride_; }
  static constexpr std::uint32_t kMostBuffers = 32;

  /// 0 or a negative errno; `who` tells the open files apart.
  int control(const void* who, std::uint32_t request, void* argument);
  int opened(const void* who);
  void closed(const void* who);
  [[nodiscard]] short poll_events(const void* who);

  /// Waits for the next frame's time, and fills a buffer through store(offset, bytes). False when no frame
  /// came of it.
  bool tick(const std::function<void(std::uint64_t, const std::vector<std::uint8_t>&)>& store);

  /// A line from the test: unplug, plug, pause, resume, lose N, spoil N, shorten N, deny, occupy, allow,
  /// crop N (it sends parts of its picture, whose edges are multiples of N),
  /// stretch (says that its lines are longer than there is room for), rename NAME, counts ("frames made, of
  /// them lost for want of a buffer, times it was held up itself").
  std::string command(const std::string& line);
  [[nodiscard]] bool gone();

 private:
  int set_format(v4l2_format& format, bool keep);
  int buffers(const void* who, std::uint32_t request, void* argument);
  int settings(std::uint32_t request, void* argument);
  int selection(bool set, v4l2_selection& selection);

  std::mutex mutex_;
  std::string card_;
  std::vector<Mode> modes_;
  Mode now_;
  std::uint64_t stride_;
  const void* owner_ = nullptr;
  std::uint32_t count_ = 0;
  bool streaming_ = false;
  std::deque<std::uint32_t> queued_;
  std::deque<v4l2_buffer> done_;
  std::uint32_t sequence_ = 0;
  std::int64_t due_ns_ = 0;
  std::uint64_t made_ = 0, starved_ = 0, held_up_ = 0;
  int gain_ = 10;
  int exposure_ = 50;
  int focus_ = 0;
  int automatic_focus_ = 1;
  int automatic_gain_ = 1;
  int automatic_ = V4L2_EXPOSURE_APERTURE_PRIORITY;
  std::uint32_t crop_step_ = 0;  ///< 0: it sends its whole picture only
  std::uint32_t crop_x_ = 0, crop_y_ = 0;
  bool gone_ = false, paused_ = false, denied_ = false, occupied_ = false, stretched_ = false;
  int lose_ = 0, spoil_ = 0, shorten_ = 0;
  std::vector<std::uint8_t> picture_, frame_;  ///< as painted, as sent
};

}  // namespace dubsar::test
