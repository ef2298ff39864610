// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/engine_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "build_paths.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {
namespace {

/// All string literals of the engine's sources, adjacent ones joined, with {} and what it holds taken out.
std::string words_of_the_engine() {
  std::string all;
  for (const char* folder : {"station", "registration", "planning", "triangulation", "archive", "analysis"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(DUBSAR_SOURCE_DIR) / folder)) {
      if (entry.path().extension() == ".cpp") {
        std::ifstream in(entry.path());
        all.append(std::istreambuf_iterator<char>(in), {});
      }
    }
  }
  return std::regex_replace(all, std::regex("\"\\s*\\n\\s*\""), "");
}

TEST(EngineWords, EveryPhraseIsStillSaidByTheEngine) {
  const std::string said = words_of_the_engine();
  ASSERT_GT(said.size(), 100000U);
  for (const EnginePhrase& phrase : engine_phrases()) {
    std::string english = phrase.english;
    // Where to turn is put together of the face's name, and what a scan can do on an overlap of a word.
    if (english.starts_with("turn the ")) {
      continue;
    }
    for (const char* word : {"turn on it", "slide on it"}) {
      english = english.substr(0, english.find(word));
    }
    const std::size_t first = english.find_first_not_of(' ');
    EXPECT_NE(said.find(english.substr(first)), std::string::npos) << english;
  }
}

TEST(EngineWords, NoPhraseHidesALongerOneBehindIt) {
  const auto phrases = engine_phrases();
  for (std::size_t a = 0; a < phrases.size(); ++a) {
    for (std::size_t b = a + 1; b < phrases.size(); ++b) {
      EXPECT_EQ(std::string(phrases[b].english).find(phrases[a].english), std::string::npos)
          << phrases[a].english << " stands before " << phrases[b].english;
    }
  }
}

TEST(EngineWords, SentencesOfUnsureScansAreGerman) {
  EXPECT_EQ(
      translated("the surfaces agree in only 41 % of the overlap; scan again with more overlap, or click "
                 "three points on both scans",
                 Language::kGerman),
      "die Flächen stimmen überein in nur 41 % der Überlappung; mit mehr Überlappung neu scannen, oder "
      "drei Stellen in beiden Scans anklicken");
  EXPECT_EQ(translated("scan 4 is taken out", Language::kGerman), "scan 4 ist entfernt");
}

}  // namespace
}  // namespace dubsar::ui
