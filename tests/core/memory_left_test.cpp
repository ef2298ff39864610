// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/memory_left.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMiB = 1 << 20;

/// The kernel's files of a machine of 8 GiB, 6 of them free.
class MemoryLeftTest : public ::testing::Test {
 protected:
  MemoryLeftTest() {
    write("proc/meminfo",
          "MemTotal:        8388608 kB\nMemFree:          524288 kB\nMemAvailable:    6291456 kB\n");
  }
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((root_.path() / file).parent_path());
    std::ofstream(root_.path() / file) << text;
  }
  [[nodiscard]] MemoryLeft left() const { return memory_left(root_.path().c_str()); }

  test::TemporaryFolder root_;
};

TEST_F(MemoryLeftTest, IsWhatTheMachineHas) {
  EXPECT_EQ(left().total_bytes, 8192 * kMiB);
  EXPECT_EQ(left().free_bytes, 6144 * kMiB);
}

TEST_F(MemoryLeftTest, IsWhatTheControlGroupGrants) {
  write("proc/self/cgroup", "12:pids:/\n8:memory:/station/work\n0::/\n");
  write("sys/fs/cgroup/memory/station/work/memory.limit_in_bytes", "2147483648\n");
  write("sys/fs/cgroup/memory/station/work/memory.usage_in_bytes", "1610612736\n");
  write("sys/fs/cgroup/memory/station/work/memory.stat",
        "cache 9\ntotal_cache 9\ntotal_inactive_file 104857600\ntotal_active_file 52428800\n");
  EXPECT_EQ(left().total_bytes, 2048 * kMiB);
  EXPECT_EQ(left().free_bytes, (512 + 100 + 50) * kMiB) << "pages of files can be had back";
}

TEST_F(MemoryLeftTest, IsTheNarrowestOfTheGroupsAround) {
  write("proc/self/cgroup", "0::/user/app\n");
  write("sys/fs/cgroup/user/app/memory.max", "max\n");
  write("sys/fs/cgroup/user/app/memory.current", "1048576\n");
  write("sys/fs/cgroup/user/memory.max", "1073741824\n");
  write("sys/fs/cgroup/user/memory.current", "1072693248\n");
  EXPECT_EQ(left().total_bytes, 1024 * kMiB);
  EXPECT_EQ(left().free_bytes, kMiB);
}

TEST_F(MemoryLeftTest, AGroupThatHasMoreThanItsLimitHasNoneLeft) {
  write("proc/self/cgroup", "0::/\n");
  write("sys/fs/cgroup/memory.max", "1000000\n");
  write("sys/fs/cgroup/memory.current", "1000001\n");
  EXPECT_EQ(left().free_bytes, 0);
}

TEST_F(MemoryLeftTest, IsUnknownWhereTheKernelSaysNothing) {
  write("proc/meminfo", "MemTotal: no number\n");
  EXPECT_EQ(left().total_bytes, 0);
  fs::remove_all(root_.path() / "proc");
  EXPECT_EQ(left().total_bytes, 0);
}

TEST(MemoryLeft, OfThisMachineIsKnown) {
  EXPECT_GT(memory_left().total_bytes, 64 * kMiB);
  EXPECT_LE(memory_left().free_bytes, memory_left().total_bytes);
}

}  // namespace
}  // namespace dubsar
