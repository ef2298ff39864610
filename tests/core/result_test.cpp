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

TEST(Error, ASchemeThatStandsAloneHasOneColon) {
  const Error error{ErrorKind::kUsage, "no option speed", "sim:", "it takes seed"};
  EXPECT_EQ(error.line(), "sim: no option speed; it takes seed");
}

TEST(Error, ExitStatusFollowsTheContract) {
  EXPECT_EQ(exit_status(ErrorKind::kUsage), 2);
  EXPECT_EQ(exit_status(ErrorKind::kBadInput), 2);
  EXPECT_EQ(exit_status(ErrorKind::kDevice), 3);
  EXPECT_EQ(exit_status(ErrorKind::kInternal), 4);
}

}  // namespace
}  // namespace dubsar
