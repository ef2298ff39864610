// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/heap.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <thread>

namespace dubsar {
namespace {

std::size_t mapped_bytes() {
  return mallinfo2().hblkhd;
}

TEST(Heap, LargeBlocksStayMappingsOfTheirOwnWhateverWasLetGoOf) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "a sanitizer brings its own allocator";
#endif
  map_large_blocks();
  constexpr std::size_t kLargest = 16 * kOwnMappingBytes;
  // Without the setting, letting go of this one would raise the threshold above the next one.
  std::unique_ptr<char[]> first(new char[kLargest]);
  std::memset(first.get(), 1, kLargest);
  first.reset();
  const std::size_t before = mapped_bytes();
  std::unique_ptr<char[]> second(new char[2 * kOwnMappingBytes]);
  std::memset(second.get(), 1, 2 * kOwnMappingBytes);
  EXPECT_GE(mapped_bytes(), before + 2 * kOwnMappingBytes);
  second.reset();
  EXPECT_EQ(mapped_bytes(), before);
}

// A program that draws by the processor takes and lets go of these many times a second.
TEST(Heap, MiddlingBlocksDoNotGoBackToTheSystemEachTime) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "a sanitizer brings its own allocator";
#endif
  map_large_blocks();
  std::array<void*, 6> blocks{};
  const auto end_of_heap_after_use = [&] {
    for (void*& block : blocks) {
      block = std::malloc(kOwnMappingBytes / 2);
      std::memset(block, 1, kOwnMappingBytes / 2);
    }
    void* const end = sbrk(0);
    for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
      std::free(*block);
    }
    return end;
  };
  const void* const used = end_of_heap_after_use();
  EXPECT_EQ(sbrk(0), used);
  EXPECT_EQ(end_of_heap_after_use(), used);
  return_unused_memory();
  EXPECT_LT(sbrk(0), used);
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(Heap, WhatAThreadHasLetGoOfIsNotKeptForIt) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "a sanitizer brings its own allocator";
#endif
  map_large_blocks();
  return_unused_memory();
  const std::size_t before = resident_bytes();
  constexpr std::size_t kBlock = kOwnMappingBytes / 2;
  std::size_t at_most = 0;
  std::thread([&] {
    std::array<void*, 96> blocks{};
    for (void*& block : blocks) {
      block = std::malloc(kBlock);
      std::memset(block, 1, kBlock);
    }
    at_most = resident_bytes();
    for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
      std::free(*block);
    }
  }).join();
  return_unused_memory();
  ASSERT_GE(at_most, before + 90 * kBlock);
  EXPECT_LE(resident_bytes(), before + 16 * kBlock);  // 4 MiB of 48, and what the thread was
}

}  // namespace
}  // namespace dubsar
