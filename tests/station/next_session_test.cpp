// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/next_session.h"

#include <gtest/gtest.h>

#include "station/packing.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(NextSession, CountsOnPastWhatIsThere) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(next_session_name(folder.path() / "box"), "box-2");
  EXPECT_EQ(next_session_name(folder.path() / "box/"), "box-2");
  EXPECT_EQ(next_session_name(folder.path() / "box-9"), "box-10");
  EXPECT_EQ(next_session_name(folder.path() / "VAT-12-a"), "VAT-12-a-2");
  EXPECT_EQ(next_session_name(folder.path() / "BM-12345"), "BM-12345-2");
  EXPECT_EQ(next_session_name(folder.path() / "box-2147483647"), "box-2147483647-2");
  std::filesystem::create_directory(folder.path() / "box-2");
  EXPECT_EQ(next_session_name(folder.path() / "box"), "box-3");
  std::filesystem::create_directory(folder.path() / "box");
  const std::filesystem::path stood = std::filesystem::current_path();
  std::filesystem::current_path(folder.path() / "box");
  EXPECT_EQ(next_session_name("."), "box-3");
  EXPECT_EQ(usual_package_of(".").parent_path().filename(), "box.results");
  std::filesystem::current_path(stood);
}

}  // namespace
}  // namespace dubsar
