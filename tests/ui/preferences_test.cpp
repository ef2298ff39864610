// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/seen_syncs.h"
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

TEST(Preferences, AreThereAfterAPowerCut) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "dubsar" / "window.conf";
  std::filesystem::create_directories(folder.path() / "dubsar" / "window.conf.new");  // in nobody's way
  test::forget_syncs();
  Preferences kept;
  kept.operator_name = "A. Reader";
  write_preferences(file, kept);
  EXPECT_EQ(read_preferences(file), kept);
  EXPECT_TRUE(test::was_synced(file)) << "before it took its name";
  EXPECT_TRUE(test::was_synced(file.parent_path()));
}

TEST(Preferences, AreAsTheyWereWhereNothingCanBeWritten) {
  const test::TemporaryFolder folder;
  test::put(folder.path() / "file", "no folder");
  write_preferences(folder.path() / "file" / "window.conf", Preferences());  // says nothing
  EXPECT_EQ(test::text_of_file(folder.path() / "file"), "no folder");
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

TEST(Preferences, LettersAreAsLargeAsTheDisplayIsSetUntilTheOperatorChooses) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "window.conf";
  const float usual = Preferences().font_px;
  EXPECT_EQ(read_preferences(file, usual_preferences(1.5F)).font_px, 1.5F * usual);
  EXPECT_EQ(read_preferences(file, usual_preferences(4)).font_px, kLargestFontPx);
  EXPECT_EQ(read_preferences(file, usual_preferences(0)).font_px, usual);
  test::put(file, "font_px = 20\n");
  EXPECT_EQ(read_preferences(file, usual_preferences(1.5F)).font_px, 20);
}

}  // namespace
}  // namespace dubsar::ui
