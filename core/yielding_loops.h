// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <thread>

namespace dubsar {

/// From now on the threads that help in parallel loops (core/parallel.h) yield to the others of this process:
/// a window must answer while all cores compute. Who calls such a loop keeps its own priority
/// (yield_this_thread()); the thread that calls this always does.
void make_loops_yield();

/// For a loop: its chunks ask one of these, made by the thread that calls the loop, before they work. (The
/// pool starts threads whenever it likes, each with the priority of the one that woke it: only while they
/// work can all be reached.)
class LoopHelpers {
 public:
  LoopHelpers() : yield_(yield_all_.load(std::memory_order_relaxed)), caller_(std::this_thread::get_id()) {}
  void let_yield() const {
    if (yield_ && std::this_thread::get_id() != caller_) {
      let_helper_yield();
    }
  }

 private:
  friend void make_loops_yield();
  static void let_helper_yield();
  inline static std::atomic<bool> yield_all_{false};
  bool yield_;
  std::thread::id caller_;
};

}  // namespace dubsar
