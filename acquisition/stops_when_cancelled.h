// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "core/job.h"
#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// kDevice, with what to do by hand: a device that was told to stop, by its emergency stop where `is_halt`,
/// gave this answer, by which it did not. Nothing where it obeyed.
[[nodiscard]] std::optional<Error> not_obeyed(const Status& answer, bool is_halt);

/// While it lives, a device that is driven on another thread is stopped when the job is cancelled, and by its
/// emergency stop (its stop, where it has none) when the job is halted or `halted` is set: within some
/// milliseconds. A stop that comes before the motion has begun is lost, so it is said until this goes; one of
/// the halts is said in any case.
class StopsWhenCancelled {
 public:
  /// Nothing is watched of a device that cannot stop.
  StopsWhenCancelled(const Device& device, const JobContext& job, const std::atomic<bool>* halted = nullptr);
  ~StopsWhenCancelled();
  StopsWhenCancelled(const StopsWhenCancelled&) = delete;
  StopsWhenCancelled& operator=(const StopsWhenCancelled&) = delete;

  /// Ends the watching: what the device answered when it was stopped last. OK where nobody asked for a stop.
  Status end();
  /// Ends the watching: not_obeyed() of the last answer. Whoever made the call end may have seen that the job
  /// was cancelled before the watch did: then the device is stopped now.
  [[nodiscard]] std::optional<Error> refused();

 private:
  [[nodiscard]] bool halted() const;
  void halt_device();
  void watch(const std::stop_token& done);

  const Device& device_;
  const JobContext& job_;
  const std::atomic<bool>* halted_;
  bool said_ = false;  ///< the device's emergency stop; read when the watcher has ended
  Status answer_;      ///< likewise
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watcher_;
};

}  // namespace dubsar
