// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A tone is no reason for anything to end.
#include "ui/shell/sound.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace dubsar::ui {
namespace {

TEST(Sound, OfATemporaryFolderThatIsGoneIsNone) {
  const char* const set = std::getenv("TMPDIR");
  const std::optional<std::string> before = set != nullptr ? std::optional<std::string>(set) : std::nullopt;
  ::setenv("TMPDIR", "/there/is/no/such/folder", 1);
  EXPECT_NO_THROW(play(Sound::kDone));
  before ? ::setenv("TMPDIR", before->c_str(), 1) : ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace dubsar::ui
