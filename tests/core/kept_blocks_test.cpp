// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/kept_blocks.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

namespace dubsar {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20U;

void* taken(KeptBlocks& blocks, std::size_t bytes) {
  void* const block = std::malloc(bytes);
  blocks.count(block);
  return block;
}

TEST(KeptBlocks, WhatWasLetGoOfComesBackToWhoAsksForAboutAsMuch) {
  KeptBlocks blocks;
  void* const first = taken(blocks, 5 * kMiB);
  void* const second = taken(blocks, 6 * kMiB);
  ASSERT_TRUE(blocks.keep(second));
  ASSERT_TRUE(blocks.keep(first));
  EXPECT_EQ(blocks.take(5 * kMiB), first);
  EXPECT_EQ(blocks.take(5 * kMiB), second);
  EXPECT_EQ(blocks.take(5 * kMiB), nullptr);
  EXPECT_EQ(blocks.kept_bytes(), 0U);
  std::free(first);
  std::free(second);
}

TEST(KeptBlocks, NeverIsMoreInUseAndKeptThanOnceWasInUse) {
  KeptBlocks blocks;
  void* const first = taken(blocks, 8 * kMiB);
  void* const second = taken(blocks, 8 * kMiB);
  ASSERT_TRUE(blocks.keep(first));
  ASSERT_TRUE(blocks.keep(second));
  EXPECT_GE(blocks.kept_bytes(), 16 * kMiB);
  EXPECT_EQ(blocks.take(2 * kMiB), nullptr);  // neither fits well: one has to go
  EXPECT_GE(blocks.kept_bytes(), 8 * kMiB);
  EXPECT_LT(blocks.kept_bytes(), 14 * kMiB);
  EXPECT_EQ(blocks.take(12 * kMiB), nullptr);
  EXPECT_EQ(blocks.kept_bytes(), 0U);
}

TEST(KeptBlocks, SmallAndVeryLargeBlocksAreNotKept) {
  KeptBlocks blocks;
  void* const small = std::malloc(KeptBlocks::kLeastBlock / 2);
  EXPECT_FALSE(blocks.keep(small));
  std::free(small);
  void* const large = taken(blocks, KeptBlocks::kMostKept + kMiB);
  EXPECT_FALSE(blocks.keep(large));
  std::free(large);
  EXPECT_FALSE(blocks.keep(nullptr));
  EXPECT_EQ(blocks.kept_bytes(), 0U);
}

TEST(KeptBlocks, TheOldestGoWhenThereAreTooMany) {
  KeptBlocks blocks;
  constexpr std::size_t kMany = 100;
  std::array<void*, kMany> all{};
  for (void*& block : all) {
    block = taken(blocks, 2 * kMiB);
  }
  for (void* const block : all) {
    ASSERT_TRUE(blocks.keep(block));
  }
  EXPECT_LE(blocks.kept_bytes(), 65 * 2 * kMiB);
  void* const block = blocks.take(2 * kMiB);
  EXPECT_NE(block, nullptr);
  std::free(block);
  blocks.free_all();
  EXPECT_EQ(blocks.kept_bytes(), 0U);
}

}  // namespace
}  // namespace dubsar
