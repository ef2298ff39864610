// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/thread_priority.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace dubsar {

ThreadPriority prefer_this_thread(ThreadTakes what) {
  const int lowest = ::sched_get_priority_min(SCHED_RR);
  const int wanted = what == ThreadTakes::kPackets ? lowest + 1 : lowest;
  for (int priority = wanted; priority >= lowest; --priority) {  // the right may end at the lowest
    const sched_param asked{.sched_priority = priority};
    // 0 is the calling thread, not the process.
    if (::sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &asked) == 0) {
      return ThreadPriority::kRealTime;
    }
  }
  constexpr int kNice = -10;
  const auto thread = static_cast<id_t>(::syscall(SYS_gettid));
  return ::setpriority(PRIO_PROCESS, thread, kNice) == 0 ? ThreadPriority::kHigh : ThreadPriority::kUsual;
}

void yield_this_thread() {
  constexpr int kNice = 10;
  const auto thread = static_cast<id_t>(::syscall(SYS_gettid));
  if (::getpriority(PRIO_PROCESS, thread) < kNice) {
    ::setpriority(PRIO_PROCESS, thread, kNice);  // downwards everybody may
  }
}

}  // namespace dubsar
