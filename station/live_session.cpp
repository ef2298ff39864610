// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/live_session.h"

#include <algorithm>
#include <utility>

#include "station/device_patience.h"
#include "station/packing.h"
#include "station/signing.h"

namespace dubsar {

namespace {

/// Nothing but motors is told of a view before it is scanned.
bool tells_of_motors(const Event& event) {
  const auto* waits = std::get_if<WaitsForOperator>(&event);
  return std::holds_alternative<NextPlacement>(event) || (waits != nullptr && waits->next);
}

}  // namespace

LiveSession::LiveSession(Options options, std::function<void()> on_change)
    : options_(std::move(options)), on_change_(std::move(on_change)) {}

LiveSession::~LiveSession() {
  {
    const std::scoped_lock lock(mutex_);
    if (engine_) {
      engine_->post(KeepHalfScan{});
    }
    closing_ = true;
    looking_.cancel();
    cancel();
    if (watch_) {
      watch_->stop();
    }
  }
  std::optional<DevicePatience> patience;
  if (options_.given_up) {
    patience.emplace([] { return true; }, nullptr, options_.given_up);
  }
  if (worker_.joinable()) {
    worker_.join();
  }
  watch_.reset();  // a rig's laser is lit for it, and a session is opened for minutes
  keep_words();
  keeps_refused_record();  // what refused it may have let go of the session
}

GrowingRows LiveSession::look_at_growing(std::uint64_t scan, int known) {
  const std::scoped_lock lock(mutex_);
  GrowingRows out;
  out.scan = growing_number_;
  out.total = growing_.rows;
  out.since = std::exchange(unseen_since_, std::nullopt);
  out.rows.cols = growing_.cols;
  const bool from_the_start = scan != growing_number_ || known > growing_.rows;
  if (!from_the_start && known == growing_.rows && !out.since) {
    out.first = known;
    return out;
  }
  out.first = from_the_start ? 0 : std::max(0, known - GridPicture::kUnsettledRows);
  out.rows.rows = growing_.rows - out.first;
  const auto cells = static_cast<std::ptrdiff_t>(out.first) * growing_.cols;
  out.rows.shade.assign(growing_.shade.begin() + cells, growing_.shade.end());
  out.rows.state.assign(growing_.state.begin() + cells, growing_.state.end());
  return out;
}

std::string LiveSession::device() const {
  const std::scoped_lock lock(mutex_);
  return options_.device;
}

void LiveSession::set_device(std::string uri) {
  {
    const std::scoped_lock lock(mutex_);
    if (options_.device != uri) {
      settings_.reset();  // those of this one are read where they are wanted
      state_.panel.reset();
      state_.is_driven = false;
      state_.error.reset();  // the other scanner's
    }
    options_.device = std::move(uri);
    options_.is_device_asked = true;
  }
  look_after_rig();
}

void LiveSession::changed() const {
  if (on_change_) {
    on_change_();
  }
}

bool LiveSession::is_occupied() const {
  const std::scoped_lock lock(mutex_);
  return busy_ && !unasked_;
}

std::shared_ptr<JobContext> LiveSession::new_job() {
  return std::make_shared<JobContext>(
      [this](std::string_view stage, double fraction) { progress(stage, fraction); });
}

void LiveSession::launch(std::function<void()> job, Job kind) {
  {
    const std::scoped_lock lock(mutex_);
    if (unasked_ && !next_) {
      take_word(kind);
      next_ = std::move(job);
      hurry();
      return;
    }
    if (busy_.exchange(true)) {
      state_.notice = kNotBegun;
      return;
    }
    job_ = new_job();
    take_word(kind);
    state_.reads_folder = kind == Job::kReads;
    device_told_.reset();
  }
  if (worker_.joinable()) {
    worker_.join();
  }
  worker_ = std::thread([this, first = std::move(job)] {
    take_device();
    first();
    do_what_was_asked();
    changed();
  });
}

void LiveSession::end(const Status& status) {
  const std::scoped_lock lock(mutex_);
  if (!status && status.error().kind != ErrorKind::kCancelled) {
    state_.error = status.error();
  }
}

void LiveSession::read() {
  launch(
      [this] {
        read_folder();
        look_for_package({});
      },
      Job::kReads);
}

void LiveSession::scan_now() {
  {
    const std::scoped_lock lock(mutex_);
    if (engine_) {
      if (engine_->post(ScanNow{}) && state_.phase == LivePhase::kWaiting) {
        state_.phase = LivePhase::kMoving;  // hands off from the key on, and no second key by mistake
      }
      return;
    }
    if (busy_) {
      take_later_word();
      scan_later_ = true;
      hurry();
      return;
    }
  }
  launch([this] { run_engine({}, false); });
}

void LiveSession::finish() {
  {
    const std::scoped_lock lock(mutex_);
    if (engine_) {
      if (engine_->post(Finish{})) {
        finish_asked_ = true;
        if (state_.phase == LivePhase::kWaiting) {
          state_.phase = LivePhase::kFinishing;  // nothing is to be turned any more, and no key scans
        }
      }
      return;
    }
    if (!state_.exists || (busy_ && !unasked_)) {
      return;
    }
  }
  judge();
}

void LiveSession::cancel() {
  if (job_) {
    job_->cancel();
  }
  if (busy_) {
    tell_device();
  }
  hurry();
}

bool LiveSession::is_away_from_device() const {
  return !busy_ || unasked_ || state_.reads_folder;
}

void LiveSession::stop() {
  const std::scoped_lock lock(mutex_);
  if (is_away_from_device()) {
    drop_asked();
    hurry();
    return;
  }
  cancel();
}

void LiveSession::halt() {
  const std::scoped_lock lock(mutex_);
  scan_later_ = false;
  halted_ = looks_;
  const bool is_away = is_away_from_device();
  state_.halted = !is_away;
  if (!is_away || watch_) {
    tell_device();
  }
  if (engine_) {
    engine_->halt();
    return;
  }
  if (watch_) {
    watch_->halt();
  }
  if (is_away) {  // and nothing begins by itself
    drop_asked();
  } else {  // an artefact that is measured, perhaps
    job_->halt();
  }
}

void LiveSession::sign(const SignOff& wanted) {
  launch([this, wanted] {
    {
      const std::scoped_lock lock(mutex_);
      state_.phase = LivePhase::kSigning;
    }
    changed();
    if (!keeps_refused_record()) {
      return;
    }
    const Result<Signing> signing = sign_verdict(options_.session, wanted, *job_);
    if (!signing) {
      end(std::unexpected(signing.error()));
      return;
    }
    if (signing->refused) {
      end(std::unexpected(*signing->refused));
      const std::scoped_lock lock(mutex_);
      state_.checklist = signing->checklist;  // whether the session is whole is known anew
      return;
    }
    const std::scoped_lock lock(mutex_);
    state_.checklist = signing->checklist;
    state_.signed_off = true;
    state_.signed_by = signing->made->name;
    state_.void_signed_by.clear();
    if (signing->no_pages) {
      state_.notice = signing->no_pages->line();
    }
  });
}

void LiveSession::pack(const std::filesystem::path& to) {
  launch([this, to] {
    {
      const std::scoped_lock lock(mutex_);
      state_.phase = LivePhase::kPacking;
      state_.package.clear();
    }
    changed();
    if (!keeps_refused_record()) {
      return;
    }
    const Result<Packing> packing =
        pack_session({.session = options_.session, .to = to, .package = {}, .update = true}, *job_);
    if (!packing) {
      end(std::unexpected(packing.error()));
      return;
    }
    const std::scoped_lock lock(mutex_);
    state_.package = to;
    if (packing->package.kept.files > 0) {
      state_.notice = sentence_of(packing->package.kept);
    }
  });
}

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
