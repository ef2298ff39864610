// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"
#include "ui/shell/theme.h"

namespace dubsar::ui {
namespace {

TEST(Preferences, ComeBackAsTheyWereKept) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "dubsar" / "window.conf";
  Preferences kept;
  kept.language = Language::kGerman;
  kept.dark = !kept.dark;
  kept.blue_for_red = kept.sound = true;
  kept.font_px = 21.5F;
  kept.operator_name = "A. Reader";
  kept.device = "sim:?seed=7";
  write_preferences(file, kept);
  EXPECT_EQ(read_preferences(file), kept);
}

TEST(Preferences, LettersWithoutASizeHaveTheUsualOne) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "window.conf";
  for (const char* px : {"nan", "inf", "large", ""}) {
    test::put(file, std::string("font_px = ") + px + "\n");
    EXPECT_EQ(read_preferences(file).font_px, Preferences().font_px) << px;
  }
  test::put(file, "font_px = 1000\n");
  EXPECT_EQ(read_preferences(file).font_px, kLargestFontPx);
}

}  // namespace
}  // namespace dubsar::ui
