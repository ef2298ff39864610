// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/driver_call.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>

#include "core/result.h"

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

/// The calls that this thread stands in.
thread_local int calls_of_this_thread = 0;

/// exit() from within a driver would end the program with whatever status the driver chose, 0 for instance:
/// "done, and conclusive". What is stored is whole without the rest of the way out.
void tell_of_an_exit() {
  if (calls_of_this_thread == 0) {
    return;
  }
  const std::optional<PendingCall> call = longest_driver_call();
  const Error ended{ErrorKind::kDevice, "the driver ended the program", call ? call->device : std::string(),
                    "what is stored is whole; update or remove the driver"};
  std::fprintf(stderr, "dubsar: %s\n", ended.line().c_str());
  ::_exit(exit_status(ended.kind));
}

}  // namespace

DriverCall::DriverCall(const std::string& device) noexcept {
  [[maybe_unused]] static const int kWatched = std::atexit(tell_of_an_exit);
  ++calls_of_this_thread;
  try {
    Calls& all = calls();
    const std::scoped_lock lock(all.mutex);
    place_ = all.pending.insert(all.pending.end(), {device, std::chrono::steady_clock::now()});
  } catch (const std::bad_alloc&) {  // the call is made all the same
    place_.reset();
  }
}

DriverCall::~DriverCall() {
  --calls_of_this_thread;
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
