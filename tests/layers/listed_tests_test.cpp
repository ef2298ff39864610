// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A test that no target names would never run, and nobody would miss it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "build_paths.h"

namespace {

namespace fs = std::filesystem;

TEST(ListedTests, EveryTestIsNamedInItsFolder) {
  int tests = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(DUBSAR_SOURCE_DIR) / "tests")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with("_test.cpp")) {
      continue;
    }
    ++tests;
    std::ifstream list(entry.path().parent_path() / "CMakeLists.txt");
    bool listed = false;
    for (std::string word; list >> word;) {
      listed = listed || word == name || word == name + ")";
    }
    EXPECT_TRUE(listed) << entry.path() << " is in no target";
  }
  EXPECT_GT(tests, 100);
}

}  // namespace
