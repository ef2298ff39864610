// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace dubsar {

/// Cancellation and progress of one long job. Cheap to poll from any thread; work never throws to stop.
/// `cancel` may be set from a signal handler or another thread; the job then returns ErrorKind::kCancelled
/// and leaves nothing half-written.
class JobContext {
 public:
  using ProgressSink = std::function<void(std::string_view stage, double fraction)>;

  JobContext() = default;
  explicit JobContext(ProgressSink sink) : sink_(std::move(sink)) {}
  JobContext(const JobContext&) = delete;
  JobContext& operator=(const JobContext&) = delete;

  void cancel() noexcept { cancelled_.store(true, std::memory_order_release); }
  [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_acquire); }
  /// The emergency stop: cancelled, and a device that the job drives is to stop at once, lasers off, whatever
  /// that does to its position. From where `cancel` may be called from.
  void halt() noexcept {
    halted_.store(true, std::memory_order_relaxed);
    cancel();  // releases it: whoever sees the job cancelled by this sees it halted, and stops nothing gently
  }
  [[nodiscard]] bool halted() const noexcept { return halted_.load(std::memory_order_relaxed); }
  /// fraction in [0, 1]. The sink is called on the caller's thread and must be thread-safe.
  void progress(std::string_view stage, double fraction) const {
    if (sink_) {
      sink_(stage, fraction);
    }
  }

 private:
  ProgressSink sink_;
  std::atomic<bool> cancelled_{false};
  std::atomic<bool> halted_{false};
};

}  // namespace dubsar
