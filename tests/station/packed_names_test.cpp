// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the files of a package are called: nothing is written over another.
#include "station/packed_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace dubsar {
namespace {

using ::testing::ElementsAre;

TEST(PackedNames, EveryDocumentHasAFileOfItsOwn) {
  EXPECT_THAT(document_files({"calibration 2026-01-02T03:04:05Z", "red_map"}),
              ElementsAre("calibration_2026-01-02T03_04_05Z.json", "red_map.json"));
  EXPECT_THAT(document_files({"a b", "a/b", "a_b", "a_b_2"}),
              ElementsAre("a_b_3.json", "a_b_4.json", "a_b.json", "a_b_2.json"))
      << "the one that is called so has the name";
}

TEST(PackedNames, ADocumentIsNotWrittenOverTheEventsOfThePackage) {
  EXPECT_THAT(document_files({"events"}), ElementsAre("events_2.json"));
}

TEST(PackedNames, CapitalsDoNotPartTwoFilesEverywhere) {
  EXPECT_THAT(document_files({"Rig", "rig"}), ElementsAre("Rig.json", "rig_2.json"));
}

TEST(PackedNames, AnyNameIsOneThatADiskTakes) {
  const std::string longer(300, 'x');
  EXPECT_THAT(document_files({"", longer, longer + "y", "nul"}),
              ElementsAre("document.json", std::string(64, 'x') + ".json", std::string(64, 'x') + "_2.json",
                          "document_nul.json"));
}

TEST(PackedNames, ManyThatAreCalledAlikeTakeNoTime) {
  std::vector<std::string> names;
  for (int k = 0; k < 20'000; ++k) {
    names.push_back(std::string(70, '?') + std::to_string(k));
  }
  const std::vector<std::string> files = document_files(names);
  EXPECT_EQ(std::set<std::string>(files.begin(), files.end()).size(), names.size());
}

}  // namespace
}  // namespace dubsar
