// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A live session's engine, from its start to what it leaves.

#include <utility>

#include "station/live_session.h"

namespace dubsar {

namespace {

/// Nothing but motors is told of a view before it is scanned.
bool tells_of_motors(const Event& event) {
  const auto* waits = std::get_if<WaitsForOperator>(&event);
  return std::holds_alternative<NextPlacement>(event) || (waits != nullptr && waits->next);
}

}  // namespace

void LiveSession::run_engine(std::vector<OperatorCommand> first, bool first_scan_waits) {
  EngineOptions options;
  JobContext* job = nullptr;
  std::shared_ptr<Engine> engine;
  std::string uri;
  bool is_described = false;
  std::filesystem::path package;
  {
    const std::scoped_lock lock(mutex_);
    if (job_->cancelled() || state_.halted) {  // between the word and its run
      later_.insert(later_.begin(), first.begin(), first.end());
      drop_asked();
      return;
    }
    // What was asked for while this run began is of this run. Behind it, it would be words that are not
    // heeded for hours, and a scan that begins by itself where somebody takes the tablet away.
    first.insert(first.end(), later_.begin(), later_.end());
    later_.clear();
    if (std::exchange(scan_later_, false)) {
      first_scan_waits = false;
    }
    options.device = uri = options_.device;
    options.session = options_.session;
    options.pins = options_.pins;
    options.settings = settings_.value_or(SettingWords());  // the engine reads what is kept itself
    options.automatic = true;
    options.paced = true;
    options.yields = true;
    options.first_scan_waits = first_scan_waits;
    options.show_model = true;
    options.first_commands = std::move(first);
    is_described = !(state_.record == TabletRecord{});
    if (is_described) {
      options.first_commands.insert(options.first_commands.begin(), DescribeTablet{state_.record});
    }
    engine = std::make_shared<Engine>(std::move(options), [this](const Event& event) {
      if (tells_of_motors(event)) {
        const std::scoped_lock told(mutex_);
        state_.is_driven = true;
      }
      hear(event);
    });
    engine_ = engine;
    job = job_.get();
    state_.phase = LivePhase::kOpening;
    state_.reads_folder = false;
    device_told_.reset();  // of the run before
    finish_asked_ = false;
    state_.next.reset();
    state_.signed_off = false;
    package = std::exchange(state_.package, {});
    state_.checklist.reset();
  }
  changed();
  const Result<EngineResult> result = engine->run(*job);
  look_for_broken_off();
  // What was set while it ran is in the session.
  const Result<SessionStore> store = open_to_look();
  Result<SettingWords> kept = store ? kept_settings(*store, uri) : std::unexpected(store.error());
  const auto scans = store ? store->scans() : std::unexpected(store.error());
  {
    const std::scoped_lock lock(mutex_);
    if (closing_) {  // nobody sees the notice that they were not heeded: they are kept
      std::vector<OperatorCommand> words = engine->take_unheeded();
      std::erase_if(words, [](const OperatorCommand& word) {
        return std::holds_alternative<DescribeTablet>(word);  // record_told_ has it
      });
      later_.insert(later_.begin(), words.begin(), words.end());
    }
    if (job_->cancelled() || state_.halted) {
      drop_asked();
    }
    if (scans) {
      show_faults(*store, *scans);
      show_hints(*store);
    }
    if (kept) {
      settings_ = std::move(*kept);
    }
    engine_.reset();
    state_.next.reset();
    // A run that has failed may not have come to it.
    const std::optional<TabletRecord> told = std::exchange(record_told_, std::nullopt);
    record_later_ = record_later_ || result ? record_later_ : told;
    if (result && (is_described || told)) {  // it may have been refused
      state_.record_kept = store && tablet_record_of(*store) == state_.record;
    }
    if (result) {
      follow(result->poses);
      state_.red_map = std::make_shared<const RedMap>(result->red_map);
      state_.verdict_kept = true;
      state_.checklist = result->checklist;
      state_.error = result->device_error;
      if (const auto& signed_off = result->checklist.sign_off) {
        show_signature(*signed_off);
      }
    }
  }
  if (!result) {
    end(std::unexpected(result.error()));
    // The device with it: whoever looks through its camera wants it while a package is looked through.
    engine.reset();
    if (store && begins_afterwards()) {
      verdict_after_break(*store);
      look_for_package(package);
    }
  }
  changed();
}

}  // namespace dubsar
