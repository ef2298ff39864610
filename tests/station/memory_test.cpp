// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Where memory is short, large arrays lie in files (core/file_blocks.h): slower, and the same bytes come out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Memory, WhatDoesNotFitLiesInFilesAndTheMeshIsTheSame) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "the sanitizers bring their own operator new";
#endif
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  ASSERT_EQ(
      run_command({"simulate", "tablet", "--size", "24x20x10", "--spacing", "0.1", "-o", at("t")}).status, 0);
  ASSERT_EQ(run_command({"simulate", "scans", "--tablet", at("t/tablet.ply"), "--views", "2", "--noise",
                         "0.005", "--spacing", "0.04", "-o", at("s")})
                .status,
            0);
  const auto stitch = [&](const char* mesh, const char* arrays) {
    return run_command({"stitch", at("s"), "--poses", at("s/truth_poses.json"), "-o", at(mesh)},
                       {.environment = {std::string("DUBSAR_ARRAYS=") + arrays}});
  };
  const Outcome in_memory = stitch("memory.ply", "memory");
  ASSERT_EQ(in_memory.status, 0) << in_memory.err;
  EXPECT_THAT(in_memory.err, Not(HasSubstr("memory was short")));
  const Outcome in_files = stitch("files.ply", "files");
  ASSERT_EQ(in_files.status, 0) << in_files.err;
  EXPECT_THAT(in_files.err, HasSubstr("memory was short"));
  EXPECT_GT(bytes_of(at("memory.ply")).size(), 1'000'000U);
  EXPECT_TRUE(bytes_of(at("memory.ply")) == bytes_of(at("files.ply")));
}

}  // namespace
}  // namespace dubsar
