// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/lasting_thread.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace dubsar {
namespace {

TEST(LastingThread, RunsEverythingOnOneThreadAndOneAtATime) {
  LastingThread lasting;
  std::vector<std::thread::id> where;  // only ever touched there
  {
    std::vector<std::jthread> callers;
    for (int k = 0; k < 8; ++k) {
      callers.emplace_back([&] {
        for (int i = 0; i < 50; ++i) {
          lasting.run([&] { where.push_back(std::this_thread::get_id()); });
        }
      });
    }
  }
  ASSERT_EQ(where.size(), 400U);
  for (const std::thread::id id : where) {
    EXPECT_EQ(id, where.front());
    EXPECT_NE(id, std::this_thread::get_id());
  }
}

TEST(LastingThread, ThrowsWhereItWasCalledAndGoesOn) {
  LastingThread lasting;
  EXPECT_THROW(lasting.run([] { throw std::runtime_error("no"); }), std::runtime_error);
  int ran = 0;
  lasting.run([&] { ++ran; });
  EXPECT_EQ(ran, 1);
}

}  // namespace
}  // namespace dubsar
