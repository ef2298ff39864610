// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

// What sources refuse, held against the tables of German phrases.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "build_paths.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui::test {

/// A source without comments, adjacent string literals joined.
inline std::string source_of(const std::string& file) {
  std::ifstream in(std::filesystem::path(DUBSAR_SOURCE_DIR) / file);
  const std::string all{std::istreambuf_iterator<char>(in), {}};
  const std::string bare = std::regex_replace(all, std::regex("//[^\\n]*|#include[^\\n]*"), "");
  return std::regex_replace(bare, std::regex("\"\\s*\\n\\s*\""), "");
}

/// The string literals of what a source refuses: within the statements that make an error.
inline std::vector<std::string> refusals_in(const std::string& file) {
  static const std::regex kMaker(
      R"re((fail|bad_input|report|error_of|usb_error|told|complain|damaged|refused?|reject|faulty|distrusted|)re"
      R"re(storage_error|info_error|line_error|ptx_error|error_at|beyond|take|range_from)\([^;]*;|)re"
      R"re(\{ErrorKind::[^;]*;|const(expr)? (const )?char\* k\w+ ?= ?[^;]*;|return "[^;]*;)re");
  static const std::regex kLiteral(R"re("([^"\n]*)")re");
  // A mend may hold a semicolon of its own.
  const std::string source = std::regex_replace(source_of(file), std::regex("; (?=[a-z])"), "\x01 ");
  std::vector<std::string> out;
  for (std::sregex_iterator call(source.begin(), source.end(), kMaker), end; call != end; ++call) {
    const std::string text = call->str();
    for (std::sregex_iterator one(text.begin(), text.end(), kLiteral); one != end; ++one) {
      out.push_back(std::regex_replace((*one)[1].str(), std::regex("\x01"), ";"));
    }
  }
  return out;
}

/// Every sentence of these sources' refusals is put into German whole; how many there are. `no_sentence`:
/// what stands between the parts of a sentence, or is one in both languages.
inline int expect_german(std::initializer_list<const char*> files, const std::set<std::string>& no_sentence) {
  // Words that a German sentence does not have.
  static const std::regex english(
      "\\b(and|the|is|it|its|see|not|with|does|that|this|ask|give|are|from|for|of|to|or|has)\\b");
  int sentences = 0;
  for (const char* file : files) {
    for (const std::string& sentence : refusals_in(file)) {
      const bool has_words = std::regex_search(sentence, std::regex("[a-z]{2}.* | .*[a-z]{2}"));
      const bool is_typed = sentence.starts_with("write ") && sentence.find(' ', 6) == std::string::npos;
      if (!has_words || is_typed || no_sentence.contains(sentence)) {
        continue;
      }
      ++sentences;
      const std::string german = translated(sentence, Language::kGerman);
      EXPECT_NE(german, sentence) << file;
      // What is typed stays as it is.
      const std::string words =
          std::regex_replace(german, std::regex("`[^`]*`|\\([a-z]* verify [^)]*\\)?"), "");
      EXPECT_FALSE(std::regex_search(words, english)) << file << ": " << german;
    }
  }
  return sentences;
}

}  // namespace dubsar::ui::test
