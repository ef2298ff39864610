// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/driver_call.h"

#include <mutex>
#include <new>

namespace dubsar {

namespace {

struct Calls {
  std::mutex mutex;
  std::list<PendingCall> pending;  ///< in the order in which they began
};

/// There to the very end: a thread may stand in a driver while the program ends.
Calls& calls() {
  static auto* const kCalls = new Calls;
  return *kCalls;
}

}  // namespace

DriverCall::DriverCall(const std::string& device) noexcept {
  try {
    Calls& all = calls();
    const std::scoped_lock lock(all.mutex);
    place_ = all.pending.insert(all.pending.end(), {device, std::chrono::steady_clock::now()});
  } catch (const std::bad_alloc&) {  // the call is made all the same
    place_.reset();
  }
}

DriverCall::~DriverCall() {
  if (place_) {
    Calls& all = calls();
    const std::scoped_lock lock(all.mutex);
    all.pending.erase(*place_);
  }
}

std::optional<PendingCall> longest_driver_call() {
  Calls& all = calls();
  const std::scoped_lock lock(all.mutex);
  return all.pending.empty() ? std::nullopt : std::optional(all.pending.front());
}

}  // namespace dubsar
