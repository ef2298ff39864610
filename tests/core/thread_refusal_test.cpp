// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/thread_refusal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace dubsar {
namespace {

TEST(ThreadRefusal, IsToldApartFromDefects) {
  const std::system_error ours(std::make_error_code(std::errc::resource_unavailable_try_again));
  const std::runtime_error of_tbb("pthread_create has failed: Resource temporarily unavailable");
  for (const std::exception* thrown :
       {static_cast<const std::exception*>(&ours), static_cast<const std::exception*>(&of_tbb)}) {
    const std::optional<Error> told = thread_refusal(*thrown);
    ASSERT_TRUE(told) << thrown->what();
    EXPECT_THAT(told->mend, testing::HasSubstr("ulimit -u"));
  }
  EXPECT_FALSE(thread_refusal(std::system_error(std::make_error_code(std::errc::no_such_process))));
  EXPECT_FALSE(thread_refusal(std::logic_error("out of range")));
}

}  // namespace
}  // namespace dubsar
