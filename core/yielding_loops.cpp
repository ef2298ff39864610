// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/yielding_loops.h"

#include "core/thread_priority.h"

namespace dubsar {

namespace {

thread_local bool priority_is_settled = false;

}  // namespace

void make_loops_yield() {
  priority_is_settled = true;
  LoopHelpers::yield_all_ = true;
}

void LoopHelpers::let_helper_yield() {
  // Also where the thread of the window helps out in a loop within its own.
  if (!priority_is_settled) {
    priority_is_settled = true;
    yield_this_thread();
  }
}

}  // namespace dubsar
