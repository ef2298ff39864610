// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/result.h"
#include "drivers/driver.h"
#include "drivers/v4l2/frame_numbers.h"
#include "drivers/v4l2/modes.h"
#include "drivers/v4l2/node.h"

namespace dubsar::v4l2 {

/// What is counted over all streams of a device.
struct Counts {
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  std::uint64_t late = 0;
  std::uint64_t incomplete = 0;
};

/// A running stream of a camera: its mapped buffers are the pool, and the kernel fills them; there is no
/// thread here. Frames that need no work are lent where they lie; packed, converted, compressed or expanded
/// ones are first brought into a pool of our own, on the thread that asks for them. One thread calls next()
/// and stop(); give_back() is for any.
class Stream {
 public:
  /// The node has the mode set already; `limited`: has_limited_range(), which is expanded. kDevice when
  /// buffers or stream are refused.
  [[nodiscard]] static Result<std::shared_ptr<Stream>> start(const Node& node, const Mode& mode, bool limited,
                                                             std::uint32_t stride, std::uint32_t pool);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  using Clock = std::chrono::steady_clock;
  /// The next frame, its lease the number of a buffer; nothing when none came in time. kDevice when the
  /// camera is gone, at most half a second after it went.
  [[nodiscard]] Result<std::optional<dubsar_frame>> next(Clock::time_point until);
  void give_back(std::uint32_t buffer);
  /// Ends the stream; what is lent stays readable until it is given back and the stream is destroyed.
  void stop();

  [[nodiscard]] std::uint32_t pool() const { return static_cast<std::uint32_t>(lent_.size()); }
  [[nodiscard]] std::uint32_t lent() const;
  [[nodiscard]] Counts counts() const;

 private:
  struct Mapped {
    void* at = nullptr;
    std::size_t length = 0;
  };
  explicit Stream(const Node& node) : node_(&node) {}
  Status take_buffers(std::uint32_t pool);
  bool queue(std::uint32_t buffer) const;
  std::optional<std::uint32_t> reserve(Clock::time_point until);
  [[nodiscard]] std::optional<dubsar_frame> describe(const void* buffer, std::uint32_t used,
                                                     std::uint32_t place);
  bool copy_luma(const std::uint8_t* from, std::size_t line, std::uint32_t used,
                 std::vector<std::uint8_t>& to) const;

  const Node* node_;
  Mode mode_;
  FormatUse use_;
  bool limited_ = false;
  std::uint32_t stride_ = 0;
  std::vector<Mapped> mapped_;
  std::vector<std::vector<std::uint8_t>> copies_;  ///< own pool, of formats that are not lent as they are
  mutable std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<bool> lent_;
  Counts counts_;
  bool running_ = false;
  bool stopped_ = false;
  FrameNumbers numbers_;  ///< of the thread that calls next()
};

}  // namespace dubsar::v4l2
