// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/thread_priority.h"
#include "tests/support/processors.h"

namespace dubsar::test {

/// Makes the calling thread the one in which an emulated camera sends as fast as it can: it goes before all
/// that compute, and keeps to one processor. The kernel takes 0.05 s of each second from a processor that
/// real-time threads fill; a camera that came and went there would leave its taker waiting on that one
/// while it sends from another, as no camera of metal does.
inline void become_device_thread() {
  prefer_this_thread();
  if (const std::vector<int> processors = allowed_processors(); !processors.empty()) {
    keep_this_thread_on(processors.back());
  }
}

}  // namespace dubsar::test
