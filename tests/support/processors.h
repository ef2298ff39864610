// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sched.h>

#include <vector>

namespace dubsar::test {

/// Those that the calling thread may run on, ascending; empty where the kernel does not tell.
inline std::vector<int> allowed_processors() {
  std::vector<int> out;
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    for (int one = 0; one < CPU_SETSIZE; ++one) {
      if (CPU_ISSET(one, &allowed)) {
        out.push_back(one);
      }
    }
  }
  return out;
}

inline bool keep_this_thread_on(int processor) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  return ::sched_setaffinity(0, sizeof one, &one) == 0;
}

}  // namespace dubsar::test
