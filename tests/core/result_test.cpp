// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/result.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(Error, IsOneLineWhateverTheFileSaid) {
  const Error error{ErrorKind::kBadInput, "bad\nheader\x1b[2J", "a\tb.ply", "export it again"};
  EXPECT_EQ(error.line(), "a?b.ply: bad?header?[2J; export it again");
}

TEST(Error, ExitStatusFollowsTheContract) {
  EXPECT_EQ(exit_status(ErrorKind::kUsage), 2);
  EXPECT_EQ(exit_status(ErrorKind::kBadInput), 2);
  EXPECT_EQ(exit_status(ErrorKind::kDevice), 3);
  EXPECT_EQ(exit_status(ErrorKind::kInternal), 4);
}

}  // namespace
}  // namespace dubsar
