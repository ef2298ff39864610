// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/stage_watch.h"

#include "core/thread_priority.h"

namespace dubsar {

namespace {

constexpr auto kAskEvery = std::chrono::milliseconds(4);
constexpr int kStill = 6;  // readings of a stage that stands, before it is believed to have arrived

}  // namespace

StageWatch::StageWatch(const Device& stage, std::size_t axis, std::chrono::milliseconds at_most)
    : stage_(stage),
      axis_(axis),
      until_(std::chrono::steady_clock::now() + at_most),
      thread_([this](const std::stop_token& enough) { ask(enough); }) {}

StageWatch::~StageWatch() {
  [[maybe_unused]] const Status said = finish();
}

void StageWatch::ask(const std::stop_token& enough) {
  prefer_this_thread();  // an answer that waits for a processor is one whose time is not known
  for (int still = 0; still < kStill && !enough.stop_requested();) {
    const Result<StageReading> reading = stage_.motion();
    if (!reading || axis_ >= reading->position.size()) {
      const std::lock_guard lock(mutex_);
      status_ = reading ? fail(ErrorKind::kDevice, "the stage does not tell where its axis is", stage_.uri())
                        : Status(std::unexpected(reading.error()));
      break;
    }
    track_.add(reading->timestamp_ns, reading->position[axis_], reading->uncertainty_ns);
    still = reading->moving ? 0 : still + 1;
    if (reading->moving && std::chrono::steady_clock::now() > until_) {
      const std::lock_guard lock(mutex_);
      status_ = fail(ErrorKind::kDevice, "the stage says that it moves, long after it should have arrived",
                     stage_.uri(), "see what holds it up, and home it");
      break;
    }
    std::this_thread::sleep_for(kAskEvery);
  }
  track_.close();
}

Status StageWatch::finish() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  const std::lock_guard lock(mutex_);
  return status_;
}

}  // namespace dubsar
