// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/thread_priority.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

namespace dubsar {
namespace {

int own_policy() {
  return ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
}

int own_nice() {
  return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)));
}

TEST(ThreadPriority, IsWhatItSaysAndOfThisThreadAlone) {
  const int policy = own_policy();
  const int nice = own_nice();
  std::thread([&] {
    const ThreadPriority got = prefer_this_thread();
    EXPECT_EQ(own_policy() == SCHED_RR, got == ThreadPriority::kRealTime);
    EXPECT_EQ(own_nice() < nice, got == ThreadPriority::kHigh);
    std::thread([&] { EXPECT_NE(own_policy(), SCHED_RR); }).join();
  }).join();
  EXPECT_EQ(own_policy(), policy);
  EXPECT_EQ(own_nice(), nice);
}

}  // namespace
}  // namespace dubsar
