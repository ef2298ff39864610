// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/job.h"
#include "core/thread_sanitizer.h"

#ifdef DUBSAR_THREAD_SANITIZER
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#include <tbb/task_group.h>
#endif

namespace dubsar {

/// Sorts by an order in which only equal values are equal: it is not stable.
template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
#ifdef DUBSAR_THREAD_SANITIZER
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

/// The same. Of a job that is cancelled all are there still, in any order.
template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less, const JobContext& job) {
#ifdef DUBSAR_THREAD_SANITIZER
  if (!job.cancelled()) {
    std::sort(begin, end, less);
  }
#else
  tbb::task_group_context context;
  tbb::task_group(context).run_and_wait([&] {
    tbb::parallel_sort(begin, end, [&](const auto& a, const auto& b) {
      if (job.cancelled()) [[unlikely]] {
        context.cancel_group_execution();  // what has not begun by now is left as it is
      }
      return less(a, b);
    });
  });
#endif
}

}  // namespace dubsar
