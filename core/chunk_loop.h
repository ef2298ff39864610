// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/thread_sanitizer.h"

#ifdef DUBSAR_THREAD_SANITIZER
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include <cstddef>

#include "core/yielding_loops.h"

namespace dubsar {

#ifdef DUBSAR_THREAD_SANITIZER

/// How many chunks may be worked on at once.
inline std::size_t chunks_at_once() {
  return 4;
}

/// body(chunk) for each of [0, chunks), on up to four threads however few the cores are: races need company.
/// The first exception of a body is thrown again here.
template <class Body>
void for_each_chunk(std::size_t chunks, const Body& body) {
  const std::size_t threads = chunks_at_once();
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr thrown;
  const LoopHelpers helpers;
  const auto work = [&] {
    helpers.let_yield();
    try {
      for (std::size_t chunk = next++; chunk < chunks; chunk = next++) {
        body(chunk);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      thrown = thrown ? thrown : std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < std::min(threads, chunks); ++k) {
      others.emplace_back(work);
    }
    work();
  }
  if (thrown) {
    std::rethrow_exception(thrown);
  }
}

#else

inline std::size_t chunks_at_once() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

/// body(chunk) for each of [0, chunks), in any order, several at once.
template <class Body>
void for_each_chunk(std::size_t chunks, const Body& body) {
  const LoopHelpers helpers;
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    helpers.let_yield();
    body(chunk);
  });
}

#endif

}  // namespace dubsar
