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

/// The calls that this thread stands in, and of those that are known of the one that began last.
thread_local int calls_of_this_thread = 0;
thread_local const PendingCall* innermost_of_this_thread = nullptr;

/// exit() from within a driver would end the program with whatever status the driver chose, 0 for instance:
/// "done, and conclusive". What is stored is whole without the rest of the way out.
void tell_of_an_exit() {
  if (calls_of_this_thread == 0) {
    return;
  }
  const PendingCall* call = innermost_of_this_thread;  // nobody else takes it out of the list
  const Error ended{ErrorKind::kDevice, "the driver ended the program",
                    call != nullptr ? call->device : std::string(),
                    "what is stored is whole; update or remove the driver"};
  std::fprintf(stderr, "dubsar: %s\n", ended.line().c_str());
  ::_exit(exit_status(ended.kind));
}

}  // namespace

DriverCall::DriverCall(std::string_view device) noexcept : outer_(innermost_of_this_thread) {
  [[maybe_unused]] static const int kWatched = std::atexit(tell_of_an_exit);
  ++calls_of_this_thread;
  try {
    Calls& all = calls();
    const std::scoped_lock lock(all.mutex);
    place_ = all.pending.insert(all.pending.end(), {std::string(device), std::chrono::steady_clock::now()});
    innermost_of_this_thread = &**place_;
  } catch (const std::bad_alloc&) {  // the call is made all the same
    place_.reset();
  }
}

DriverCall::~DriverCall() {
  --calls_of_this_thread;
  innermost_of_this_thread = outer_;
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
