// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "core/result.h"

namespace dubsar {

/// A device that was told to stop, and whose driver has not come back for so long, does not answer: the
/// operator is told. More than a move takes to end, and as much as a control transfer that hangs in the
/// kernel.
inline constexpr std::chrono::seconds kSilentAfter{5};
/// And after so long nobody waits for it any more who has nothing else to do.
inline constexpr std::chrono::seconds kGivenUpAfter{10};

/// The device whose driver has kept a call for `at_least` since it was told to stop; nothing where all come
/// back. A call that began later counts from when it began.
[[nodiscard]] std::optional<std::string> silent_device(std::chrono::steady_clock::time_point told,
                                                       std::chrono::steady_clock::duration at_least);

/// What a window says of it.
[[nodiscard]] Error silence_of(const std::string& device);

/// Waits beside whoever waits for a device, on a thread of its own, and loses patience with one that does not
/// come back. Where the system starts no thread it does nothing.
class DevicePatience {
 public:
  using Say = std::function<void(const Error&)>;

  /// `is_told`: whether the device was told to stop, which is not taken back. `silent` is called after
  /// kSilentAfter and `given_up` after kGivenUpAfter, with what there is to say: the latter ends the program.
  /// `answers`: what `silent` told of has come back after all. `silent` and `answers` may be empty. All on
  /// the thread of this.
  DevicePatience(std::function<bool()> is_told, Say silent, Say given_up,
                 std::function<void()> answers = nullptr);
  ~DevicePatience();
  DevicePatience(const DevicePatience&) = delete;
  DevicePatience& operator=(const DevicePatience&) = delete;

 private:
  void watch(const std::stop_token& done);

  std::function<bool()> is_told_;
  Say silent_;
  Say given_up_;
  std::function<void()> answers_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watcher_;
};

}  // namespace dubsar
