// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The device beside the scans: what its camera sees, what is set, whether it still measures right.
#include <utility>

#include "station/live_session.h"
#include "station/told_session.h"

namespace dubsar {

std::shared_ptr<const CameraView> LiveSession::camera() const {
  const std::scoped_lock lock(mutex_);
  return camera_;
}

void LiveSession::watch_camera(bool on) {
  std::shared_ptr<CameraWatch> over;  // goes outside of the lock: its thread may want it
  {
    const std::scoped_lock lock(mutex_);
    looks_ = on;
    halted_ = halted_ && on;
    on = on && !halted_;
    if (watch_ && watch_->ended()) {
      over = std::exchange(watch_, nullptr);
      if (!busy_ || unasked_) {
        device_told_.reset();
      }
      on = on && over == nullptr;  // one that ended by itself has said why; the next call tries again
    }
    if (engine_) {
      engine_->post(WatchCamera{on});
    } else if (!on && watch_) {
      watch_->stop();
    } else if (on && !watch_ && (!busy_ || unasked_) && !options_.device.empty()) {
      watch_ = std::make_shared<CameraWatch>(
          options_.device, [this, device = options_.device] { return known_settings(device); },
          [this](const Event& event) { hear(event); },
          [this, device = options_.device](const std::string& key, const std::string& word) {
            keep_setting(device, key, word);  // whatever scanner is chosen by then
          });
    }
  }
}

void LiveSession::light_camera(bool on) {
  const std::scoped_lock lock(mutex_);
  if (watch_) {
    watch_->light(on);
  }
}

void LiveSession::change_setting(const std::string& key, const std::string& word) {
  const std::scoped_lock lock(mutex_);
  state_.notice.clear();  // why another word was refused
  if (engine_ && engine_->post(ChangeSetting{key, word})) {
    return;
  }
  if (engine_ || !watch_ || !watch_->change({key, word})) {
    state_.notice = kNotSet;
  }
}

void LiveSession::take_device() {
  std::shared_ptr<CameraWatch> watch;
  {
    const std::scoped_lock lock(mutex_);
    watch = std::exchange(watch_, nullptr);
    if (watch) {
      tell_device();
    }
  }
  watch.reset();  // the device is the job's
  const std::scoped_lock lock(mutex_);
  if (!job_->cancelled()) {
    device_told_.reset();
  }
}

void LiveSession::tell_device() {
  device_told_ = device_told_.value_or(std::chrono::steady_clock::now());
}

SettingWords LiveSession::known_settings(const std::string& device) {
  {
    const std::scoped_lock lock(mutex_);
    if (settings_ && device == options_.device) {
      return *settings_;
    }
  }
  SettingWords kept;
  if (SessionStore::is_session(options_.session)) {
    const Result<SessionStore> store = SessionStore::open(options_.session, SessionStore::Access::kReadOnly);
    Result<SettingWords> read = store ? kept_settings(*store, device) : std::unexpected(store.error());
    end(read ? Status() : std::unexpected(read.error()));
    kept = read ? std::move(*read) : SettingWords();
  }
  const std::scoped_lock lock(mutex_);
  if (device == options_.device && !settings_) {
    settings_ = kept;
  }
  return kept;
}

void LiveSession::keep_setting(const std::string& device, const std::string& key, const std::string& word) {
  SettingWords all = known_settings(device);
  put_word(all, key, word);
  {
    const std::scoped_lock lock(mutex_);
    if (device == options_.device) {
      settings_ = all;
    }
  }
  // Without a session it is put, and kept, by the first run.
  if (SessionStore::is_session(options_.session)) {
    Result<SessionStore> store = open_for_a_word(options_.session);
    end(store ? note_settings(*store, device, all) : std::unexpected(store.error()));
  }
}

void LiveSession::look_after_rig() {
  std::optional<RigCare> care = care_of(device());
  const std::scoped_lock lock(mutex_);
  state_.care = std::move(care);
}

void LiveSession::verify(const VerifyRequest& request) {
  launch([this, request] {
    {
      const std::scoped_lock lock(mutex_);
      state_.verification.reset();
      state_.phase = LivePhase::kMeasuring;
    }
    changed();
    Result<VerifyOutcome> outcome = verify_rig(request, *job_);
    if (!outcome) {
      end(std::unexpected(outcome.error()));
      return;
    }
    look_after_rig();
    const std::scoped_lock lock(mutex_);
    state_.verification = std::make_shared<const VerifyOutcome>(std::move(*outcome));
  });
}

void LiveSession::calibrate(const CalibrateRequest& request) {
  launch([this, request] {
    {
      const std::scoped_lock lock(mutex_);
      state_.phase = LivePhase::kMeasuring;
    }
    changed();
    Result<CalibrateOutcome> outcome = calibrate_folder(request, *job_);
    if (!outcome) {
      end(std::unexpected(outcome.error()));
      return;
    }
    look_after_rig();
    const std::scoped_lock lock(mutex_);
    state_.calibration = std::make_shared<const CalibrateOutcome>(std::move(*outcome));
    state_.notice = request.out.empty() ? std::string() : "kept: " + request.out;
  });
}

}  // namespace dubsar
