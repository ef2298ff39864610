// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/heap.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstring>
#include <memory>

namespace dubsar {
namespace {

std::size_t mapped_bytes() {
  return mallinfo2().hblkhd;
}

TEST(Heap, LargeBlocksStayMappingsOfTheirOwnWhateverWasLetGoOf) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
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

}  // namespace
}  // namespace dubsar
