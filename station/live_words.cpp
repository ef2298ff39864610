// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator asks for while a job runs that does not take it: it is done behind that job, told as not
// heeded where the job was stopped, and kept where the window is closed. Nothing is dropped in silence.
#include <utility>

#include "acquisition/operator_log.h"
#include "core/log.h"
#include "station/live_session.h"
#include "station/operator_hint.h"
#include "station/session_pages.h"
#include "station/session_pins.h"
#include "station/told_session.h"

namespace dubsar {

namespace {

constexpr const char* kNotHeeded = "what was said meanwhile of scans was not heeded; say it again";

/// A word of a scan as `dubsar session` keeps it; the poses follow it when the session goes on.
Status keep_word(SessionStore& store, const OperatorCommand& command) {
  if (const auto* drop = std::get_if<DropScan>(&command)) {
    const auto undone = drop->id < 0 ? store.undo_last_scan() : Result<std::optional<int>>(drop->id);
    const Status status = undone ? Status() : std::unexpected(undone.error());
    return drop->id < 0 ? status : store.drop_scan(drop->id, drop->why);
  }
  if (const auto* retake = std::get_if<ScanAgain>(&command)) {
    return store.drop_scan(retake->id, "to be scanned again");
  }
  if (const auto* restore = std::get_if<RestoreScan>(&command)) {
    return store.restore_scan(restore->id);
  }
  if (const auto* hint = std::get_if<HintScan>(&command)) {
    const Result<PoseHint> settled = settled_hint(store, hint->id, hint->given);
    return settled ? record_hint(store, hint->id, *settled) : std::unexpected(settled.error());
  }
  if (const auto* withdraw = std::get_if<WithdrawHint>(&command)) {
    return record_hint_withdrawn(store, withdraw->id);
  }
  if (const auto* lock = std::get_if<LockScan>(&command)) {
    const Result<ScanLock> here = lock_here(store, lock->id);
    return here ? record_lock(store, lock->id, *here) : std::unexpected(here.error());
  }
  if (const auto* unlock = std::get_if<UnlockScan>(&command)) {
    return record_unlock(store, unlock->id);
  }
  if (const auto* label = std::get_if<LabelPins>(&command)) {
    return keep_pin_labels(store, label->id, label->tips, label->tip_diameter_mm);
  }
  return {};
}

}  // namespace

void LiveSession::ask(OperatorCommand command) {
  {
    const std::scoped_lock lock(mutex_);
    mark_hint(command);
    if (engine_ && engine_->post(command)) {
      return;
    }
    if (busy_) {
      take_later_word();
      later_.push_back(std::move(command));
      hurry();
      return;
    }
  }
  launch([this, command = std::move(command)] { run_engine({command}, true); });
}

void LiveSession::hurry() {
  if (unasked_) {
    unasked_->cancel();
  }
}

void LiveSession::take_word(Job kind) {
  if (kind != Job::kMendsNothing) {
    state_.error.reset();
  }
  state_.halted = false;
}

void LiveSession::take_later_word() {
  if (unasked_) {
    take_word(Job::kPlain);
  }
}

void LiveSession::do_what_was_asked() {
  for (;;) {
    std::vector<OperatorCommand> commands;
    bool waits = true;
    std::function<void()> next;
    std::optional<TabletRecord> record;
    {
      const std::scoped_lock lock(mutex_);
      unasked_.reset();
      state_.reads_folder = false;
      if (job_->cancelled() || state_.halted) {
        drop_asked();
      }
      next = std::exchange(next_, nullptr);
      record = std::exchange(record_later_, std::nullopt);
      if (!next && !record) {
        waits = !std::exchange(scan_later_, false);
        if (!closing_) {
          commands.assign(later_.begin(), later_.end());
          later_.clear();
        }
        if (commands.empty() && waits) {
          state_.phase = LivePhase::kStill;
          state_.stage.clear();
          device_told_.reset();
          busy_ = false;
          return;
        }
      }
    }
    if (record) {  // also when nothing else is wanted any more
      keep_record(*record);
    }
    if (next) {
      take_device();
      next();
    } else if (!record) {
      take_device();
      run_engine(std::move(commands), waits);
    }
  }
}

void LiveSession::drop_asked() {
  scan_later_ = false;
  if (std::exchange(next_, nullptr) && !closing_) {
    state_.notice = kNotBegun;
  }
  if (!later_.empty() && !closing_) {
    later_.clear();
    state_.notice = kNotHeeded;
    mark_hints();
  }
}

void LiveSession::keep_words() {
  if (later_.empty()) {
    return;
  }
  Result<SessionStore> store = open_for_a_word(options_.session);
  for (const OperatorCommand& command : later_) {
    const Status taken = store ? take_pages_back(*store, "something was said of its scans", kFollowAndPlan)
                               : std::unexpected(store.error());
    if (const Status kept = taken ? keep_word(*store, command) : taken; !kept) {
      log_warning(kept.error().line());  // there is no window any more to say it in
    }
  }
  later_.clear();
}

void LiveSession::mark_hint(const OperatorCommand& command) {
  if (const auto* hint = std::get_if<HintScan>(&command)) {
    scan_of(hint->id).hinted = true;
  } else if (const auto* withdraw = std::get_if<WithdrawHint>(&command)) {
    scan_of(withdraw->id).hinted = false;
  }
}

void LiveSession::mark_hints() {
  for (LiveScan& scan : state_.scans) {
    scan.hinted = hints_kept_.contains(scan.id);
  }
  for (const OperatorCommand& command : later_) {
    mark_hint(command);
  }
}

void LiveSession::show_hints(const SessionStore& store) {
  if (const Result<OperatorLog> log = read_operator_log(store)) {
    hints_kept_.clear();
    for (const auto& [id, hint] : log->word.hints) {
      hints_kept_.insert(id);
    }
    mark_hints();
  }
}

}  // namespace dubsar
