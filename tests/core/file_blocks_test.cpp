// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/file_blocks.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace dubsar {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20U;

/// Lines of the program's map of memory that are files without a name.
int mapped_files() {
  std::ifstream maps("/proc/self/maps");
  int count = 0;
  for (std::string line; std::getline(maps, line);) {
    count += line.find("(deleted)") != std::string::npos ? 1 : 0;
  }
  return count;
}

TEST(FileBlocks, AreMemoryThatLiesInAFileWithoutAName) {
  const int before = mapped_files();
  const std::size_t size = 3 * kMiB + 5;
  auto* const block = static_cast<unsigned char*>(allocate_file_block(size, 16));
  ASSERT_NE(block, nullptr) << "no disk in $TMPDIR or /var/tmp";
  EXPECT_EQ(mapped_files(), before + 1);
  EXPECT_EQ(block[0], 0);
  block[0] = 1;
  block[size - 1] = 2;
  EXPECT_EQ(block[0] + block[size - 1], 3);
  EXPECT_TRUE(free_file_block(block));
  EXPECT_EQ(mapped_files(), before);
  EXPECT_FALSE(free_file_block(block)) << "gone already";
}

TEST(FileBlocks, LieWhereTheyWereAskedFor) {
  void* const block = allocate_file_block(kMiB, 2 * kMiB);
  ASSERT_NE(block, nullptr);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % (2 * kMiB), 0U);
  EXPECT_TRUE(free_file_block(block));
}

TEST(FileBlocks, OfOthersAreLeftAlone) {
  std::vector<char> mine(64);
  EXPECT_FALSE(free_file_block(mine.data()));
  EXPECT_FALSE(free_file_block(nullptr));
}

TEST(FileBlocks, CountTheMostThatLayInFilesAtOnce) {
  void* const a = allocate_file_block(8 * kMiB, 16);
  void* const b = allocate_file_block(8 * kMiB, 16);
  ASSERT_NE(a, nullptr);
  ASSERT_NE(b, nullptr);
  EXPECT_GE(most_file_block_bytes(), 16 * kMiB);
  EXPECT_TRUE(free_file_block(b));
  EXPECT_TRUE(free_file_block(a));
  EXPECT_GE(most_file_block_bytes(), 16 * kMiB);
}

TEST(FileBlocks, ADiskWithoutRoomGivesNone) {
  EXPECT_EQ(allocate_file_block(std::size_t{1} << 60U, 16), nullptr);
}

TEST(FileBlocks, ComeAndGoOnManyThreads) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([t] {
      for (int round = 0; round < 50; ++round) {
        std::vector<int*> blocks;
        for (int k = 0; k < 5; ++k) {
          blocks.push_back(static_cast<int*>(allocate_file_block(kMiB, 16)));
          ASSERT_NE(blocks.back(), nullptr);
          *blocks.back() = 100 * t + k;
        }
        for (int k = 0; k < 5; ++k) {
          EXPECT_EQ(*blocks[static_cast<std::size_t>(k)], 100 * t + k);
          EXPECT_TRUE(free_file_block(blocks[static_cast<std::size_t>(k)]));
        }
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST(FileBlocks, AreForWhatMemoryCannotTake) {
  EXPECT_TRUE(belongs_in_file(std::size_t{1} << 60U));
}

}  // namespace
}  // namespace dubsar
