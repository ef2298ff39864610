// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/device_patience.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "drivers/driver_call.h"

namespace dubsar {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPause = std::chrono::milliseconds(100);

}  // namespace

std::optional<std::string> silent_device(Clock::time_point told, Clock::duration at_least) {
  std::optional<PendingCall> call = longest_driver_call();
  const bool is_silent = call && Clock::now() - std::max(told, call->since) >= at_least;
  return is_silent ? std::optional(std::move(call->device)) : std::nullopt;
}

Error silence_of(const std::string& device) {
  return {ErrorKind::kDevice,
          "the device does not answer: stop the laser and the stage by hand, or pull their plugs", device,
          fmt::format("what was stored is safe; close the window: the program then ends within {} s",
                      kGivenUpAfter.count())};
}

DevicePatience::DevicePatience(std::function<bool()> is_told, Say silent, Say given_up,
                               std::function<void()> answers)
    : is_told_(std::move(is_told)),
      silent_(std::move(silent)),
      given_up_(std::move(given_up)),
      answers_(std::move(answers)) {
  try {
    watcher_ = std::jthread([this](const std::stop_token& done) { watch(done); });
  } catch (const std::system_error&) {
    return;  // an end that is asked for twice still comes
  }
}

DevicePatience::~DevicePatience() {
  if (watcher_.joinable()) {
    watcher_.request_stop();
    watcher_.join();
  }
}

void DevicePatience::watch(const std::stop_token& done) {
  std::optional<Clock::time_point> told;
  bool is_silent = false;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, done, kPause, [&] { return done.stop_requested(); })) {
    if (done.stop_requested()) {
      return;
    }
    if (!told && is_told_()) {
      told = Clock::now();
    }
    if (!told) {
      continue;
    }
    const auto silent = silent_device(*told, kSilentAfter);
    if (silent && !is_silent && silent_) {
      Error error = silence_of(*silent);
      error.mend =
          fmt::format("what was stored is safe; the program ends in {} s, or at once by another Ctrl-C",
                      (kGivenUpAfter - kSilentAfter).count());
      silent_(error);
    }
    if (!silent && is_silent && answers_) {
      answers_();
    }
    is_silent = silent.has_value();
    if (const auto device = silent_device(*told, kGivenUpAfter)) {
      given_up_(
          {ErrorKind::kDevice, "the device does not answer: the program ends without it", *device,
           "stop the laser and the stage by hand, or pull their plugs; what was stored is safe, and the "
           "same command goes on with it"});
      return;
    }
  }
}

}  // namespace dubsar
