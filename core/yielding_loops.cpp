// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/yielding_loops.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "core/chunk_loop.h"
#include "core/thread_priority.h"

namespace dubsar {

void make_loops_yield() {
  // A thread has the priority of the one that starts it, and helpers stay once they are there: a loop that
  // needs them all, called by a thread that yields.
  std::thread([] {
    constexpr auto kPatience = std::chrono::milliseconds(200);
    yield_this_thread();
    const auto began = std::chrono::steady_clock::now();
    const std::size_t all = chunks_at_once();
    std::atomic<std::size_t> here{0};
    for_each_chunk(all, [&](std::size_t) {
      yield_this_thread();
      ++here;
      while (here < all && std::chrono::steady_clock::now() - began < kPatience) {
        std::this_thread::yield();
      }
    });
  }).join();
}

}  // namespace dubsar
