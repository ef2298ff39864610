// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// With a CDPATH of whoever calls a script, cd may go elsewhere, and says where it went.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "build_paths.h"

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool goes_to_a_folder(std::string_view script) {
  return script.find("\ncd ") != std::string_view::npos || script.find("(cd ") != std::string_view::npos;
}

TEST(Scripts, NoneThatGoesToAFolderHeedsACdpath) {
  int scripts = 0;
  for (const char* folder : {".", "docs/images", "fuzz", "packaging", "tools", "workflows"}) {
    for (const auto& entry : fs::directory_iterator(fs::path(DUBSAR_SOURCE_DIR) / folder)) {
      const std::string text = entry.is_regular_file() ? text_of(entry.path()) : std::string();
      if (text.starts_with("#!") && goes_to_a_folder(text)) {
        ++scripts;
        EXPECT_NE(text.find("\nunset CDPATH"), std::string::npos) << entry.path();
      }
    }
  }
  EXPECT_GT(scripts, 8);
}

}  // namespace
