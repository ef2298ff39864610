// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <list>
#include <optional>
#include <string>
#include <string_view>

namespace dubsar {

/// A call into a driver that has not come back yet.
struct PendingCall {
  std::string device;  ///< URI, or the driver's scheme
  std::chrono::steady_clock::time_point since;
};

/// Stands for a call into a driver while it lasts: a driver is foreign code and may never come back, and
/// whoever waits for it then has to know. On any thread; one that there is no memory for is not known of.
/// A driver that calls exit() within it, on its thread, ends the program with the status of a device that
/// failed, and a line that names it.
class DriverCall {
 public:
  explicit DriverCall(std::string_view device) noexcept;
  ~DriverCall();
  DriverCall(const DriverCall&) = delete;
  DriverCall& operator=(const DriverCall&) = delete;

 private:
  std::optional<std::list<PendingCall>::iterator> place_;
  const PendingCall* outer_;  ///< that the thread stands in around this one, or null
};

/// Of the calls of all threads the one that began first; of a rig that waits for its camera, the rig's.
[[nodiscard]] std::optional<PendingCall> longest_driver_call();

}  // namespace dubsar
