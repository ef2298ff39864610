// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the files of a package are called: nothing is written over another.
#include "station/packed_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

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

TEST(PackedNames, NoTwoNumbersShareAnAddress) {
  EXPECT_EQ(address_name("BM 12345", false), "BM_12345");
  EXPECT_EQ(address_name("P123456", false), "P123456");
  EXPECT_EQ(address_name("K.2401-a", false), "K.2401-a");
  EXPECT_EQ(address_name("BM_12345", true), "BM_12345") << "a session's folder";
  EXPECT_EQ(address_name("BM 1/2", false), "BM%201%2F2");
  const std::vector<std::string> numbers{"BM 1 2",
                                         "BM 1/2",
                                         "BM 1:2",
                                         "BM 1_2",
                                         "BM 1  2",
                                         "BM 1 2 ",
                                         " BM 1 2",
                                         "bm 1 2",
                                         "متحف ١٢٣",
                                         "متحف ١٢٤",
                                         "𒀭",
                                         "𒀀",
                                         "nul",
                                         "tablet nul",
                                         "tablet",
                                         ".",
                                         "..",
                                         ".1",
                                         std::string(64, 'x'),
                                         std::string(65, 'x'),
                                         std::string(5000, 'x'),
                                         std::string(5001, 'x'),
                                         std::string(5000, '.'),
                                         "a\nb",
                                         "a b",
                                         "%",
                                         "%25",
                                         "\xff",
                                         "\xfe"};
  std::set<std::string> names;
  for (const std::string& number : numbers) {
    const std::string name = address_name(number, false);
    EXPECT_TRUE(names.insert(name).second) << number << " is called like another: " << name;
    EXPECT_LE(name.size(), 240U);
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._%"),
              std::string::npos)
        << name;
    EXPECT_NE(name.find_first_not_of('.'), std::string::npos) << "that is a folder above";
  }
}

TEST(PackedNames, ANumberOfWhichNothingIsLeftGivesWayToTheSessionsName) {
  EXPECT_EQ(file_stem("𒀭", "BM 7"), "BM_7");
  EXPECT_EQ(file_stem("𒀭", "𒀀"), "tablet");
  EXPECT_EQ(file_stem("BM 1/2", "other"), "BM_1_2");
  EXPECT_EQ(file_stem("𒀭", "nul"), "tablet_nul");
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
