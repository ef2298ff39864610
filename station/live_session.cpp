// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/live_session.h"

#include <algorithm>
#include <utility>

#include "station/device_patience.h"
#include "station/packing.h"
#include "station/signing.h"

namespace dubsar {

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

}  // namespace dubsar
