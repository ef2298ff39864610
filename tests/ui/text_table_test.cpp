// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/text_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

#include "core/rig.h"
#include "core/units.h"

namespace dubsar::ui {
namespace {

/// What stands between braces, in order.
std::string gaps_of(const std::string& text) {
  std::string out;
  bool inside = false;
  for (const char c : text) {
    inside = inside || c == '{';
    out += inside ? std::string(1, c) : std::string();
    inside = inside && c != '}';
  }
  return out;
}

TEST(TextTable, EveryTextIsThereInBothLanguagesWithTheSameGaps) {
  for (int k = 0; k < static_cast<int>(Text::kCount); ++k) {
    const std::string english = text_of(static_cast<Text>(k), Language::kEnglish);
    const std::string german = text_of(static_cast<Text>(k), Language::kGerman);
    EXPECT_FALSE(english.empty());
    EXPECT_FALSE(german.empty());
    EXPECT_EQ(gaps_of(english), std::regex_replace(gaps_of(german), std::regex("L"), ""))
        << english << " / " << german;
    // German decimals have a comma.
    EXPECT_FALSE(std::regex_search(german, std::regex("\\.[1-9]f\\}"))) << german;
    EXPECT_EQ(gaps_of(english).find('L'), std::string::npos) << english;
    EXPECT_EQ(english.find('%'), std::string::npos) << english;
    for (const std::string& text : {english, german}) {
      EXPECT_EQ(text.find("mm2"), std::string::npos) << text;
      EXPECT_EQ(text.find("} um"), std::string::npos) << text;
    }
  }
}

/// A count may be one: "pairs: 1", never "1 pairs".
TEST(TextTable, NoCountIsFollowedByAPlural) {
  const std::regex plural("\\{(:\\.0f)?\\} ([a-z]+ )?[a-z]{2,}s\\b");
  for (int k = 0; k < static_cast<int>(Text::kCount); ++k) {
    const std::string english = text_of(static_cast<Text>(k), Language::kEnglish);
    EXPECT_FALSE(std::regex_search(english, plural)) << english;
  }
}

TEST(TextTable, TheEnginesWordsAreTranslatedAsFarAsTheyAreKnown) {
  const std::string said = "turn the reverse towards the camera, 90°; then turntable to 40°, tilt to 52°";
  EXPECT_EQ(translated(said, Language::kEnglish), said);
  EXPECT_EQ(translated(said, Language::kGerman),
            "die Rückseite zur Kamera drehen, 90°; dann Drehteller auf 40°, Neigung auf 52°");
  EXPECT_EQ(
      translated("turn the reverse towards the camera, 150°, by way of the corner between the left edge and "
                 "the top edge, and turn it where it lies, 60° clockwise seen from the camera",
                 Language::kGerman),
      "die Rückseite zur Kamera drehen, 150°, über die Ecke zwischen linkem Rand und oberem Rand, und "
      "drehen, wo sie liegt, 60° im Uhrzeigersinn, von der Kamera aus");
  EXPECT_EQ(
      translated(
          "turn it so that the corner between the right edge and the top edge comes towards the camera, "
          "40°",
          Language::kGerman),
      "so drehen, dass die Ecke zwischen rechtem Rand und oberem Rand zur Kamera kommt, 40°");
  Rig rig;
  rig.has_turntable = true;
  rig.tilt_max_rad = 1;
  Placement placement;
  placement.turntable_rad = rad_from_deg(40.0);
  placement.tilt_rad = rad_from_deg(-20.0);
  EXPECT_EQ(translated(say_placement(rig, placement), Language::kGerman),
            "Drehteller auf 40°, Neigung auf -20°");
  EXPECT_EQ(translated("something new", Language::kGerman), "something new");
}

TEST(TextTable, TheBoardOfACalibrationIsNoTablet) {
  for (const Text text : {Text::kCalibrateHow, Text::kBoard, Text::kShotBoard, Text::kCameraLine}) {
    const std::string german = text_of(text, Language::kGerman);
    EXPECT_EQ(german.find("Tafel"), std::string::npos) << german;
    EXPECT_NE(german.find("Muster"), std::string::npos) << german;
  }
}

}  // namespace
}  // namespace dubsar::ui
