// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/thread_priority.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

#include "core/parallel.h"
#include "core/yielding_loops.h"

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

TEST(ThreadPriority, WhoTakesPacketsGoesBeforeWhoTakesFrames) {
  const auto own_priority = [](ThreadTakes what, ThreadPriority& got) {
    sched_param own{};
    std::thread([&] {
      got = prefer_this_thread(what);
      ::sched_getparam(0, &own);
    }).join();
    return own.sched_priority;
  };
  rlimit most{};
  ASSERT_EQ(::getrlimit(RLIMIT_RTPRIO, &most), 0);
  const rlim_t right = ::geteuid() == 0 ? 99 : most.rlim_cur;
  ThreadPriority frames{};
  ThreadPriority packets{};
  const int of_frames = own_priority(ThreadTakes::kFrames, frames);
  const int of_packets = own_priority(ThreadTakes::kPackets, packets);
  EXPECT_EQ(packets, frames);
  EXPECT_EQ(of_packets > of_frames, packets == ThreadPriority::kRealTime && right >= 2);
}

TEST(ThreadPriority, WhatComputesYieldsToTheWindowAndLeavesItAlone) {
  const int nice = own_nice();
  make_loops_yield();
  EXPECT_EQ(own_nice(), nice);
  // Helpers yield, and so does who asks to; only the thread of the window does not.
  const auto window = std::this_thread::get_id();
  parallel_chunks(64, 1, [&](std::size_t, std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_TRUE(std::this_thread::get_id() == window || own_nice() >= 10);
  });
  std::thread([] {
    yield_this_thread();
    std::thread([] { EXPECT_GE(own_nice(), 10); }).join();
  }).join();
  EXPECT_EQ(own_nice(), nice);
}

}  // namespace
}  // namespace dubsar
