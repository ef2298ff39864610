// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sched.h>

#include "core/thread_priority.h"

namespace dubsar::test {

/// Makes the calling thread the one in which an emulated camera sends as fast as it can: it goes before all
/// that compute, and keeps to one processor. The kernel takes 0.05 s of each second from a processor that
/// real-time threads fill; a camera that came and went there would leave its taker waiting on that one
/// while it sends from another, as no camera of metal does.
inline void become_device_thread() {
  prefer_this_thread();
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) {
    return;
  }
  int last = CPU_SETSIZE - 1;
  while (last > 0 && !CPU_ISSET(last, &allowed)) {
    --last;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(last, &one);
  ::sched_setaffinity(0, sizeof one, &one);
}

}  // namespace dubsar::test
