// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/packet_room.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace dubsar::aravis {
namespace {

TEST(PacketRoom, SaysHowToMakeMore) {
  constexpr std::uint64_t kDebian = 212992;
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20U;
  const auto said = scarce_room(kDebian, 2228224);
  ASSERT_TRUE(said);
  EXPECT_THAT(*said, testing::HasSubstr("keeps 208 KiB"));
  EXPECT_THAT(*said, testing::HasSubstr("sysctl -w net.core.rmem_max=33554432"));
  EXPECT_FALSE(scarce_room(4 * kMiB, 2228224));
  EXPECT_TRUE(scarce_room(4 * kMiB, 12 * kMiB));
  EXPECT_FALSE(scarce_room(32 * kMiB, 500 * kMiB));  // more is not asked for
}

TEST(PacketRoom, IsWhatTheKernelGrants) {
  std::uint64_t limit = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  if (limit == 0) {
    GTEST_SKIP() << "this kernel does not tell its limit";
  }
  EXPECT_EQ(granted_bytes(limit + (1U << 20U)), limit);
  EXPECT_EQ(granted_bytes(limit / 2), limit / 2);
}

}  // namespace
}  // namespace dubsar::aravis
