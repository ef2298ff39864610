// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/heap.h"
#include "core/thread_priority.h"
#include "station/engine_impl.h"
#include "station/followed_word.h"

namespace dubsar {

Engine::Engine(EngineOptions options, EventSink sink) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->keeps_half = impl_->options.keep_half_scan;
  impl_->commands.assign(impl_->options.first_commands.begin(), impl_->options.first_commands.end());
  impl_->sink = std::move(sink);
}
Engine::~Engine() {
  impl_.reset();
  // The window stands for days and sees many tablets: what the threads of a run have let go of goes back to
  // the system, instead of lying in their heaps in pieces.
  return_unused_memory();
}

std::vector<ScanPose> Engine::Impl::named_poses() const {
  std::vector<ScanPose> poses = registrar.poses();
  for (ScanPose& pose : poses) {
    if (const auto name = names.find(pose.id); name != names.end()) {
      pose.file = name->second;
    }
    pose = judged(std::move(pose));
  }
  tell_contradicted(poses, contradicted);
  return poses;
}

ScanPose Engine::Impl::judged(ScanPose pose) const {
  const auto known = precision.find(pose.id);
  return known != precision.end() ? known->second.judged(std::move(pose)) : pose;
}

/// The final word on all scans that there are: poses, and the red map that follows from them.
Status Engine::Impl::settle(EngineResult& result, JobContext& job) {
  {
    const StageClock timing = clock("final registration");
    if (const Status done = registrar.finalize(job); !done) {
      return done;
    }
    if (const Status done = hold_locks(job) ? registrar.finalize(job) : Status(); !done) {
      return done;
    }
  }
  result.poses = named_poses();
  if (const Status saved = save_followed_poses(*store, result.poses); !saved) {
    return saved;
  }
  const StageClock timing = clock("final planning and meshing");
  if (const Status placed = planning.place(result.poses, true, job); !placed) {
    return placed;
  }
  tell_foreign();
  Result<RedMap> red_map = planning.red_map(rig ? &*rig : nullptr, job);
  if (!red_map) {
    return std::unexpected(red_map.error());
  }
  result.red_map = std::move(*red_map);
  emit(RedMapChanged{result.red_map, std::nullopt});
  if (const Status stitched = planning.stitch(job); !stitched) {
    return stitched;
  }
  show_model(job);
  return {};
}

/// Runs the pipeline from `step` until the device has no more, or until the online red map says that nothing
/// is left to do; then settles. True when the settled map still has something to do.
Result<bool> Engine::Impl::run_round(NextStep step, EngineResult& result, JobContext& job) {
  {
    const std::scoped_lock lock(mutex);
    queues = std::make_unique<Queues>();
    takes_scans = true;
    if (!commands.empty()) {
      queues->to_register.try_push(CommandsWait{});
    }
  }
  {
    const auto computing = [&](auto work) {
      return std::jthread([this, work] {
        if (options.yields) {
          yield_this_thread();
        }
        work();
      });
    };
    const std::jthread planner = computing([&] { plan_all(job); });
    const std::jthread registration = computing([&] { register_all(job); });
    std::jthread storing([&] { keep_stored(); });
    acquire(std::move(step), job);
  }
  if (first_error) {
    return std::unexpected(*first_error);
  }
  if (stored_count == 0) {
    return std::unexpected(
        device_error.value_or(Error{ErrorKind::kBadInput, "the device gave no scan", options.device,
                                    "check what stands before the scanner"}));
  }
  if (const Status settled = settle(result, job); !settled) {
    return std::unexpected(settled.error());
  }
  const bool enough = [&] {
    const std::scoped_lock lock(mutex);
    return finish_asked;
  }();
  const bool goes_on = !enough && drives && !device_error && !has_all_scans() && !result.red_map.conclusive &&
                       !result.red_map.next.empty() && result.red_map.next.front().placement;
  return goes_on;
}

Result<EngineResult> Engine::Impl::run(JobContext& job) {
  if (const Status opened = open(job); !opened) {
    return std::unexpected(opened.error());
  }
  settle_undoing();
  EngineResult result;
  const int resumed_count = stored_count;
  NextStep step;
  for (;;) {
    const Result<bool> goes_on = run_round(std::move(step), result, job);
    if (!goes_on) {
      return std::unexpected(goes_on.error());
    }
    if (!*goes_on) {
      break;
    }
    wait_for_plan = false;
    // How the tablet lies is known only once this run has scanned it.
    step = stored_count > resumed_count ? step_to(result.red_map) : std::nullopt;
  }
  if (drives && has_all_scans() && !result.red_map.conclusive) {
    emit(Notice{stored_count == 1
                    ? "1 scan is there, as many as were to be taken; --max-scans allows more"
                    : fmt::format("{} scans are there, as many as were to be taken; --max-scans allows more",
                                  stored_count)});
  }
  while (!close_commands()) {
    {
      const std::scoped_lock lock(mutex);
      queues.reset();  // no thread of a round is there to plan after them
    }
    obey_commands(job);
    if (const Status settled = settle(result, job); !settled) {
      return std::unexpected(settled.error());
    }
  }
  if (const Status finished = finish(result, job); !finished) {
    return std::unexpected(finished.error());
  }
  return result;
}

Result<EngineResult> Engine::run(JobContext& job) {
  Result<EngineResult> result = impl_->run(job);
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->takes_commands = false;
  }
  if (!result) {
    impl_->tell_unheeded();
  }
  if (impl_->source && impl_->store) {
    impl_->change_settings();  // those that came behind the last scan
  } else {
    impl_->tell_unset();
  }
  if (!result && result.error().kind == ErrorKind::kCancelled) {
    if (const auto refused = impl_->source ? impl_->source->unstopped() : std::nullopt) {
      return std::unexpected(*refused);
    }
    const int stored = impl_->stored_count;
    if (!impl_->is_open) {  // how many scans there are was not counted then
      return fail(ErrorKind::kCancelled, "stopped while the session was opened; nothing was scanned",
                  impl_->options.session.string(), "the same command goes on with what is there");
    }
    return fail(ErrorKind::kCancelled,
                fmt::format("stopped; {} {} stored", stored, stored == 1 ? "scan is" : "scans are"),
                impl_->options.session.string(), "the same command goes on with what is there");
  }
  return result;
}

}  // namespace dubsar
