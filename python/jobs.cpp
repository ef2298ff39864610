// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "python/jobs.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace dubsar::python {

namespace {

/// What the work tells and the caller's thread reads. Only the newest progress counts.
struct Told {
  std::mutex mutex;
  std::condition_variable changed;
  std::string stage;
  double fraction = 0;
  bool news = false;
  bool done = false;
  std::exception_ptr defect;
};

/// How long Ctrl-C may go unheard.
constexpr std::chrono::milliseconds kBeat(50);

/// Python's False, or numpy's, as a comparison with a number of numpy's gives it; nothing else is.
bool is_false(const py::object& answer) {
  py::detail::make_caster<bool> truth;
  return truth.load(answer, false) && !py::detail::cast_op<bool>(truth);
}

}  // namespace

void run_job(const py::object& progress, const std::function<void(JobContext&)>& work) {
  Told told;
  JobContext job([&told](std::string_view stage, double fraction) {
    const std::scoped_lock lock(told.mutex);
    told.stage = stage;
    told.fraction = fraction;
    told.news = true;
  });
  std::thread worker([&] {
    std::exception_ptr defect;
    try {
      work(job);
    } catch (...) {
      defect = std::current_exception();
    }
    const std::scoped_lock lock(told.mutex);
    told.defect = defect;
    told.done = true;
    told.changed.notify_one();
  });

  std::optional<py::error_already_set> raised;
  bool refused = false;
  for (bool done = false; !done;) {
    std::string stage;
    double fraction = 0;
    bool news = false;
    {
      const py::gil_scoped_release others_may_run;
      std::unique_lock lock(told.mutex);
      told.changed.wait_for(lock, kBeat, [&] { return told.done; });
      done = told.done;
      stage = told.stage;
      fraction = told.fraction;
      news = std::exchange(told.news, false);
    }
    if (raised || refused) {
      continue;  // the work is being stopped
    }
    try {
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
      if (news && !progress.is_none()) {
        refused = is_false(progress(stage, fraction)) && !done;
      }
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
    }
    if (raised || refused) {
      job.cancel();
    }
  }
  {
    const py::gil_scoped_release others_may_run;
    worker.join();
  }
  if (raised) {
    throw std::move(*raised);
  }
  if (refused) {
    raise({ErrorKind::kCancelled, "stopped by progress()", {}, {}});
  }
  if (told.defect) {
    std::rethrow_exception(told.defect);
  }
}

}  // namespace dubsar::python
