// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator asks of the engine while it runs. Everything is stored before it takes effect, so that a
// session that goes on later stands where the operator left it.
#include "station/engine_impl.h"
#include "station/followed_word.h"
#include "station/session_pages.h"

namespace dubsar {

bool Engine::post(OperatorCommand command) {
  const std::scoped_lock lock(impl_->mutex);
  if (!impl_->takes_commands) {
    return false;
  }
  if (std::holds_alternative<ScanAgain>(command) && (!impl_->takes_scans || impl_->finish_asked)) {
    return false;  // it would only be taken out: that is for the next run
  }
  if (std::holds_alternative<ScanNow>(command) || std::holds_alternative<Finish>(command)) {
    (std::holds_alternative<ScanNow>(command) ? impl_->scan_asked : impl_->finish_asked) = true;
    impl_->pace.notify_all();
    return true;
  }
  if (std::holds_alternative<KeepHalfScan>(command)) {
    impl_->keeps_half = true;
    return true;
  }
  if (auto* change = std::get_if<ChangeSetting>(&command)) {
    impl_->settings_asked.push_back(std::move(*change));
    return true;
  }
  if (const auto* watch = std::get_if<WatchCamera>(&command)) {
    impl_->watch_asked = watch->on;
    return true;
  }
  impl_->commands.push_back(std::move(command));
  if (impl_->queues) {
    // A full queue wakes the registering thread by itself.
    impl_->queues->to_register.try_push(CommandsWait{});
  }
  return true;
}

std::vector<OperatorCommand> Engine::take_unheeded() {
  const std::scoped_lock lock(impl_->mutex);
  std::vector<OperatorCommand> out(impl_->commands.begin(), impl_->commands.end());
  impl_->commands.clear();
  return out;
}

void Engine::Impl::tell_unheeded() {
  const bool any = [&] {
    const std::scoped_lock lock(mutex);
    return std::ranges::any_of(commands, [](const OperatorCommand& command) {
      return !std::holds_alternative<DescribeTablet>(command);  // that is kept all the same
    });
  }();
  if (any) {
    emit(Notice{"what was said meanwhile of scans was not heeded; say it again"});
  }
}

void Engine::Impl::settle_undoing() {
  std::vector<int> standing;
  if (const auto stored = store->scans()) {
    for (const StoredScan& scan : *stored) {
      if (!scan.dropped) {
        standing.push_back(scan.id);
      }
    }
  }
  const std::scoped_lock lock(mutex);
  for (OperatorCommand& command : commands) {
    if (auto* drop = std::get_if<DropScan>(&command)) {
      if (drop->id < 0 && !standing.empty()) {
        drop->id = standing.back();
      }
      std::erase(standing, drop->id);
    }
  }
}

bool Engine::Impl::close_commands() {
  const std::scoped_lock lock(mutex);
  takes_commands = !commands.empty();
  return commands.empty();
}

std::optional<PinSet> Engine::Impl::known_pins() const {
  const std::scoped_lock lock(mutex);
  return pins;
}

Result<StationScan> Engine::Impl::enter_again(int id, JobContext& job) {
  Result<RangeGrid> grid = store->load_grid(id);
  if (!grid) {
    return std::unexpected(grid.error());
  }
  StationScan scan = prepare_scan(id, std::move(*grid), known_pins());
  {
    // Motors go by it: without, planning would take the tablet to lie as for another scan, or for not there.
    const std::scoped_lock lock(mutex);
    if (const auto drive = drives_of_scans.find(id); drive != drives_of_scans.end()) {
      scan.drive = drive->second;
    }
  }
  names[id] = scan.file;
  register_scan(scan, job);
  return scan;
}

Status Engine::Impl::read_word() {
  Result<OperatorLog> log = read_operator_log(*store);
  if (!log) {
    return std::unexpected(log.error());
  }
  word = std::move(log->word);
  lock_frame.reset();
  for (const ScanPose& pose : registrar.poses()) {
    const auto lock = word.locked.find(pose.id);
    if (lock != word.locked.end() && pose.locked &&
        pose.model_from_scanner.row_major() == lock->second.model_from_scanner.row_major()) {
      lock_frame = lock->second.frame;
    }
  }
  return {};
}

bool Engine::Impl::hold_locks(JobContext& job) {
  SettledLocks settled = settle_locks(registrar, word.locked, job);
  contradicted = std::move(settled.contradicted);
  return settled.placed;
}

void Engine::Impl::take_back_pages() {
  if (const Status taken = take_pages_back_once(*store, "something was said of its scans", kFollowAndPlan);
      !taken) {
    emit(Notice{taken.error().line()});
  }
}

bool Engine::Impl::stands(int id) const {
  const auto stored = store->scans();
  return !stored || std::ranges::any_of(*stored, [&](const StoredScan& scan) {
    return !scan.dropped && (scan.id == id || id < 0);
  });
}

Result<StationScan> Engine::Impl::bring_back(int id, JobContext& job) {
  const auto stored = store->scans();
  if (!stored) {
    return std::unexpected(stored.error());
  }
  const auto scan = std::ranges::find(*stored, id, &StoredScan::id);
  if (scan != stored->end() && !scan->dropped) {
    return fail(ErrorKind::kUsage, "scan " + std::to_string(id) + " was not taken out");
  }
  if (scan != stored->end()) {
    take_back_pages();
  }
  if (const Status restored = store->restore_scan(id); !restored) {
    return std::unexpected(restored.error());
  }
  taken_out.erase(id);
  return enter_again(id, job);
}

Result<std::vector<StationScan>> Engine::Impl::label_pins(const LabelPins& command, std::string& what,
                                                          JobContext& job) {
  if (stands(command.id)) {
    take_back_pages();
  }
  if (const Status kept = keep_pin_labels(*store, command.id, command.tips, command.tip_diameter_mm); !kept) {
    return std::unexpected(kept.error());
  }
  Result<std::optional<PinSet>> now = session_pins(*store, options.pins);
  if (!now) {
    return std::unexpected(now.error());
  }
  emit(PinsKnown{*now ? std::make_shared<const PinSet>(**now) : nullptr});
  bool all_change = false;  // what of a scan is a pin
  {
    const std::scoped_lock lock(mutex);
    all_change =
        pins.has_value() != now->has_value() || (pins && pins->tip_diameter_mm != (*now)->tip_diameter_mm);
    pins = std::move(*now);
  }
  const auto stored = store->scans();
  if (!stored) {
    return std::unexpected(stored.error());
  }
  std::vector<StationScan> out;
  for (const StoredScan& scan : *stored) {
    // A scan that is still on its way is taken in with what is known when it comes.
    if (scan.dropped || scan.damaged || !names.contains(scan.id) || (!all_change && scan.id != command.id)) {
      continue;
    }
    Result<StationScan> entered = enter_again(scan.id, job);
    if (!entered) {
      return std::unexpected(entered.error());
    }
    out.push_back(std::move(*entered));
  }
  what = "the pins of scan " + std::to_string(command.id) +
         (command.tips.empty() ? " have no labels by hand any more" : " are labelled");
  return out;
}

Result<std::vector<StationScan>> Engine::Impl::obey(const OperatorCommand& command, std::string& what,
                                                    JobContext& job) {
  const auto done = [&](const Status& status, int id, const char* said) -> Result<std::vector<StationScan>> {
    if (!status) {
      return std::unexpected(status.error());
    }
    what = "scan " + std::to_string(id) + " " + said;
    return std::vector<StationScan>();
  };
  if (const auto* drop = std::get_if<DropScan>(&command)) {
    int id = drop->id;
    Status dropped;
    if (stands(id)) {
      take_back_pages();
    }
    if (id < 0) {
      const auto newest = store->undo_last_scan();
      if (!newest || !*newest) {
        return std::unexpected(newest ? Error{ErrorKind::kUsage, "there is no scan to undo", {}, {}}
                                      : newest.error());
      }
      id = **newest;
    } else {
      dropped = store->drop_scan(id, drop->why);
    }
    if (dropped) {
      registrar.remove(id, job);
      taken_out.insert(id);
    }
    return done(dropped, id, "is taken out");
  }
  if (const auto* retake = std::get_if<ScanAgain>(&command)) {
    if (stands(retake->id)) {
      take_back_pages();
    }
    const Status dropped = store->drop_scan(retake->id, "to be scanned again");
    if (dropped) {
      registrar.remove(retake->id, job);
      taken_out.insert(retake->id);
    }
    return done(dropped, retake->id, "is taken out");
  }
  if (const auto* restore = std::get_if<RestoreScan>(&command)) {
    what = "scan " + std::to_string(restore->id) + " is put back";
    Result<StationScan> back = bring_back(restore->id, job);
    return back ? Result<std::vector<StationScan>>(std::vector{std::move(*back)})
                : std::unexpected(back.error());
  }
  if (const auto* label = std::get_if<LabelPins>(&command)) {
    return label_pins(*label, what, job);
  }
  if (const auto* hint = std::get_if<HintScan>(&command)) {
    const Result<PoseHint> settled = settled_hint(*store, hint->id, hint->given);
    if (settled) {
      take_back_pages();
    }
    Status status = settled ? record_hint(*store, hint->id, *settled) : std::unexpected(settled.error());
    if (status) {
      word.hints[hint->id] = *settled;
      status = registrar.set_hint(hint->id, *settled, job);
    }
    return done(status, hint->id, "has a hint");
  }
  if (const auto* withdraw = std::get_if<WithdrawHint>(&command)) {
    if (!word.hints.contains(withdraw->id)) {
      return fail(ErrorKind::kUsage, "there is no hint for scan " + std::to_string(withdraw->id));
    }
    take_back_pages();
    const Status status = record_hint_withdrawn(*store, withdraw->id);
    if (status) {
      word.hints.erase(withdraw->id);
      registrar.clear_hint(withdraw->id, job);
    }
    return done(status, withdraw->id, "has no hint any more");
  }
  if (const auto* lock = std::get_if<LockScan>(&command)) {
    const Result<ScanLock> here = lock_here(*store, lock->id);
    if (here) {
      take_back_pages();
    }
    const Status status = here ? record_lock(*store, lock->id, *here) : std::unexpected(here.error());
    if (status) {
      registrar.set_locked(lock->id, true);
    }
    return done(status, lock->id, "is locked");
  }
  const auto* unlock = std::get_if<UnlockScan>(&command);
  if (unlock == nullptr) {
    return fail(ErrorKind::kInternal, "a command of pace came among those to the registrar");
  }
  const int id = unlock->id;
  if (!word.locked.contains(id)) {
    return fail(ErrorKind::kUsage, "scan " + std::to_string(id) + " is not locked");
  }
  take_back_pages();
  const Status status = record_unlock(*store, id);
  if (status) {
    registrar.set_locked(id, false);
  }
  return done(status, id, "is unlocked");
}

void Engine::Impl::obey_commands(JobContext& job) {
  for (;;) {
    OperatorCommand command;
    std::shared_ptr<void> thought;
    {
      const std::scoped_lock lock(mutex);
      if (commands.empty()) {
        return;
      }
      command = std::move(commands.front());
      commands.pop_front();
      thought = begin_thought();
    }
    if (const auto* describe = std::get_if<DescribeTablet>(&command)) {
      const Status kept = keep_tablet_record(*store, describe->record);
      emit(Notice{kept ? "what is said of the tablet is kept" : kept.error().line()});
      continue;
    }
    std::string what;
    Result<std::vector<StationScan>> obeyed = obey(command, what, job);
    if (!obeyed) {
      emit(Notice{obeyed.error().line()});
      continue;
    }
    if (const Status read = read_word(); !read) {
      emit(Notice{read.error().line()});
    }
    hold_locks(job);
    std::vector<ScanPose> poses = named_poses();
    // What was broken off is not followed: signing and planning must see that.
    const Status saved = job.cancelled() ? Status() : save_followed_poses(*store, poses);
    if (!saved && queues) {
      give_up(saved.error());  // after the rounds, settling saves them once more and says so
    }
    {
      const std::scoped_lock lock(mutex);
      last_scan_taken_up = poses.empty() || poses.back().status == PoseStatus::kRegistered;
    }
    emit(
        OperatorObeyed{what, poses, drives && options.paced && queues, {taken_out.begin(), taken_out.end()}});
    if (!queues) {
      for (const StationScan& scan : *obeyed) {
        planning.add(scan);
      }
      continue;
    }
    for (std::size_t k = 0; k + 1 < obeyed->size(); ++k) {
      queues->to_plan.push({std::move((*obeyed)[k]), poses, false});
    }
    const auto* retake = std::get_if<ScanAgain>(&command);
    queues->to_plan.push({.scan = obeyed->empty() ? std::nullopt : std::optional(std::move(obeyed->back())),
                          .poses = std::move(poses),
                          .plan_now = true,
                          .device_waits = false,
                          .resumed = false,
                          .view_of = retake != nullptr ? std::optional(retake->id) : std::nullopt,
                          .thought = std::move(thought)});
  }
}

}  // namespace dubsar
