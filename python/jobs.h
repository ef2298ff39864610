// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "core/job.h"
#include "python/binding.h"

namespace dubsar::python {

/// Runs `work` on a thread of its own without the interpreter's lock, so that the caller's thread can hear
/// Ctrl-C and pass progress on to Python meanwhile. `progress` is None or progress(stage, fraction): what it
/// raises, and KeyboardInterrupt, stop the work and are raised here once the work has ended; False from it
/// raises Cancelled.
void run_job(const py::object& progress, const std::function<void(JobContext&)>& work);

/// The same for work that gives a Result; its error is raised.
template <class Work>
auto run_for_result(const py::object& progress, const Work& work) {
  // On the heap: there GCC 12 does not believe that it is read before it is written.
  std::unique_ptr<decltype(work(std::declval<JobContext&>()))> result;
  run_job(progress, [&](JobContext& job) {
    result = std::make_unique<typename decltype(result)::element_type>(work(job));
  });
  return value_of(std::move(*result));
}

}  // namespace dubsar::python
