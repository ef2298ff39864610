// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sched.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "tests/support/processors.h"

namespace dubsar {

/// How long a processor was away from everybody, from this watch's beginning: of each but the last, where an
/// emulated camera sends (device_thread.h), a thread that goes before all others of this program and asks
/// for a millisecond at a time. A virtual machine's processor goes when its host has others to run, and a
/// kernel says nothing of it; who takes packets there cannot take them.
class ProcessorWatch {
 public:
  ProcessorWatch() {
    const std::vector<int> processors = test::allowed_processors();
    for (std::size_t k = 0; k + 1 < processors.size(); ++k) {
      threads_.emplace_back([this, on = processors[k]](const std::stop_token& enough) { watch(on, enough); });
    }
  }

  /// 0 where there is nothing to watch, or no right to real-time priority.
  [[nodiscard]] double longest_s() const { return longest_s_; }

 private:
  void watch(int processor, const std::stop_token& enough) {
    using Clock = std::chrono::steady_clock;
    const sched_param high{.sched_priority = ::sched_get_priority_max(SCHED_RR)};
    if (!test::keep_this_thread_on(processor) ||
        ::sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &high) != 0) {
      return;
    }
    while (!enough.stop_requested()) {
      const Clock::time_point before = Clock::now();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const double away_s = std::chrono::duration<double>(Clock::now() - before).count() - 1e-3;
      for (double longest = longest_s_;
           away_s > longest && !longest_s_.compare_exchange_weak(longest, away_s);) {
      }
    }
  }

  std::atomic<double> longest_s_ = 0;
  std::vector<std::jthread> threads_;
};

}  // namespace dubsar
