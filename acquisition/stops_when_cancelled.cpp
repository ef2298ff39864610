// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stops_when_cancelled.h"

#include <chrono>

namespace dubsar {

namespace {

constexpr auto kPause = std::chrono::milliseconds(20);

}  // namespace

std::optional<Error> not_obeyed(const Status& answer, bool is_halt) {
  if (answer || answer.error().kind == ErrorKind::kCancelled) {
    return std::nullopt;
  }
  return Error{ErrorKind::kDevice,
               (is_halt ? "the emergency stop was pressed, but laser and motors may still be on: "
                        : "stopped, but laser and motors may still be on: ") +
                   answer.error().what,
               answer.error().where, "pull the plugs of laser and stage, or switch off their power"};
}

StopsWhenCancelled::StopsWhenCancelled(const Device& device, const JobContext& job,
                                       const std::atomic<bool>* halted)
    : device_(device), job_(job), halted_(halted) {
  if (device.can_stop()) {
    watcher_ = std::jthread([this](const std::stop_token& done) { watch(done); });
  }
}

StopsWhenCancelled::~StopsWhenCancelled() {
  [[maybe_unused]] const Status said = end();
}

Status StopsWhenCancelled::end() {
  if (watcher_.joinable()) {
    watcher_.request_stop();
    watcher_.join();
    if (halted() && !said_) {  // whoever drives it saw the halt first
      halt_device();
    }
  }
  return answer_;
}

std::optional<Error> StopsWhenCancelled::refused() {
  std::optional<Error> out = not_obeyed(end(), halted());
  if (!out && job_.cancelled() && !halted()) {
    out = not_obeyed(device_.stop(), false);
  }
  return out;
}

bool StopsWhenCancelled::halted() const {
  return job_.halted() || (halted_ != nullptr && *halted_);
}

void StopsWhenCancelled::halt_device() {
  said_ = true;
  answer_ = device_.emergency_stop();
  if (answer_) {
    return;
  }
  const Status stopped = device_.stop();
  if (answer_.error().kind == ErrorKind::kUsage) {  // it has no emergency stop
    answer_ = stopped;
  }
}

void StopsWhenCancelled::watch(const std::stop_token& done) {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, done, kPause, [&] { return done.stop_requested(); })) {
    if (done.stop_requested()) {
      return;
    }
    const bool is_cancelled = job_.cancelled();  // before: a halt that comes between is not taken for less
    if (halted()) {
      halt_device();
    } else if (is_cancelled) {
      answer_ = device_.stop();
    }
  }
}

}  // namespace dubsar
