// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/acquisition/session_support.h"
#include "tests/support/files.h"

namespace dubsar::test {

/// Turns one bit of each place where the text stands in a file.
inline void spoil(const std::filesystem::path& file, const std::string& text) {
  const std::string bytes = text_of_file(file);
  std::size_t at = bytes.find(text);
  ASSERT_NE(at, std::string::npos) << file;
  for (; at != std::string::npos; at = bytes.find(text, at + 1)) {
    flip_byte(file, at, 1);
  }
}

/// In the tables of a session and in their backup.
inline void spoil_both(const std::filesystem::path& session, const std::string& text) {
  spoil(session / "session.sqlite", text);
  spoil(session / "session.backup.sqlite", text);
}

}  // namespace dubsar::test
