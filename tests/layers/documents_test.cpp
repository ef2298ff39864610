// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What README.md and docs/ name has to be there: tests, files of the sources, pages and their headings.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "build_paths.h"

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = DUBSAR_SOURCE_DIR;
constexpr std::string_view kEllipsis = "…";

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_word(std::string_view text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

bool is_name(std::string_view text) {
  return is_word(text) && std::isupper(static_cast<unsigned char>(text.front())) != 0;
}

std::vector<fs::path> pages() {
  std::vector<fs::path> out{kRoot / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") {
      out.push_back(entry.path());
    }
  }
  return out;
}

/// Without what is between lines of ```.
std::string prose_of(const fs::path& page) {
  std::istringstream lines(text_of(page));
  std::string out;
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    const bool fence = line.starts_with("```") || line.starts_with("   ```");
    fenced = fenced != fence;
    out += fenced || fence ? "\n" : line + "\n";
  }
  return out;
}

/// What stands between backticks on one line.
std::vector<std::string> quoted_words(const std::string& prose) {
  std::vector<std::string> out;
  std::istringstream parts(prose);
  std::string part;
  for (bool within = false; std::getline(parts, part, '`'); within = !within) {
    if (within && part.find('\n') == std::string::npos) {
      out.push_back(part);
    }
  }
  return out;
}

/// The first word at `at`, which is behind it then.
std::string_view word_at(std::string_view text, std::size_t& at) {
  at = std::min(text.find_first_not_of(" \n", at), text.size());
  const std::size_t begin = at;
  while (at < text.size() && is_word(text.substr(at, 1))) {
    ++at;
  }
  return text.substr(begin, at - begin);
}

/// "Suite.Name" and "Name" of every test.
std::set<std::string> names_of_tests() {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().extension() != ".cpp") {
      continue;
    }
    const std::string text = text_of(entry.path());
    for (const std::string_view macro : {"\nTEST(", "\nTEST_F(", "\nTEST_P("}) {
      for (std::size_t at = text.find(macro); at != std::string::npos; at = text.find(macro, at)) {
        at += macro.size();
        const std::string suite(word_at(text, at));
        const std::string name(word_at(text, ++at));
        out.insert(suite + "." + name);
        out.insert(name);
      }
    }
  }
  return out;
}

/// Of "Suite.Name" and "…Name" what has to be among names_of_tests(); empty of anything else.
std::string test_in(std::string_view word) {
  if (word.starts_with(kEllipsis)) {
    word.remove_prefix(kEllipsis.size());
    return is_name(word) ? std::string(word) : std::string();
  }
  const std::size_t dot = word.find('.');
  return dot != std::string_view::npos && is_name(word.substr(0, dot)) && is_name(word.substr(dot + 1))
             ? std::string(word)
             : std::string();
}

bool is_source(const fs::path& path) {
  static const std::set<std::string> kEndings{".c", ".cpp", ".h", ".py", ".pyi"};
  return path.is_relative() && std::distance(path.begin(), path.end()) > 1 &&
         kEndings.contains(path.extension().string()) &&
         path.string().find_first_of(" <{*") == std::string::npos && !path.begin()->string().starts_with('.');
}

/// As the pages' readers make them: small letters, dashes for blanks, no other signs.
std::string anchor_of(std::string_view heading) {
  std::string out;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ') {
      out += '-';
    } else if (std::isalnum(byte) != 0 || c == '-' || c == '_' || byte >= 0x80) {
      out += static_cast<char>(std::tolower(byte));
    }
  }
  return out;
}

std::set<std::string> anchors_of(const fs::path& page) {
  std::set<std::string> out;
  std::istringstream lines(prose_of(page));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t level = line.find_first_not_of('#');
    if (level != 0 && level != std::string::npos && line[level] == ' ') {
      out.insert(anchor_of(std::string_view(line).substr(level + 1)));
    }
  }
  return out;
}

/// Where the links of a page lead, the addresses of the web left out: a file, and a heading in it or nothing.
std::vector<std::pair<fs::path, std::string>> links_of(const fs::path& page) {
  std::vector<std::pair<fs::path, std::string>> out;
  const std::string prose = prose_of(page);
  for (std::size_t at = prose.find("]("); at != std::string::npos; at = prose.find("](", at)) {
    at += 2;
    const std::string to = prose.substr(at, prose.find(')', at) - at);
    if (to.find("://") != std::string::npos) {
      continue;
    }
    const std::size_t mark = to.find('#');
    const std::string file = to.substr(0, mark);
    out.emplace_back(file.empty() ? page : (page.parent_path() / file).lexically_normal(),
                     mark == std::string::npos ? std::string() : to.substr(mark + 1));
  }
  return out;
}

TEST(Documents, TestsThatTheyNameAreThere) {
  const std::set<std::string> tests = names_of_tests();
  int named = 0;
  for (const fs::path& page : pages()) {
    for (const std::string& word : quoted_words(prose_of(page))) {
      const std::string test = test_in(word);
      named += test.empty() ? 0 : 1;
      EXPECT_TRUE(test.empty() || tests.contains(test)) << page << " names " << word << ", which is no test";
    }
  }
  EXPECT_GT(named, 50);
}

TEST(Documents, SourcesThatTheyNameAreThere) {
  int named = 0;
  for (const fs::path& page : pages()) {
    for (const std::string& word : quoted_words(prose_of(page))) {
      if (is_source(word)) {
        ++named;
        EXPECT_TRUE(fs::exists(kRoot / word)) << page << " names " << word << ", which is not there";
      }
    }
  }
  EXPECT_GT(named, 30);
}

TEST(Documents, LinksLeadToPagesAndTheirHeadings) {
  int links = 0;
  for (const fs::path& page : pages()) {
    for (const auto& [file, heading] : links_of(page)) {
      ++links;
      EXPECT_TRUE(fs::exists(file)) << page << " leads to " << file << ", which is not there";
      EXPECT_TRUE(heading.empty() || anchors_of(file).contains(heading))
          << page << " leads to " << file << ", which has no heading " << heading;
    }
  }
  EXPECT_GT(links, 100);
}

TEST(Documents, TheirFirstPageLeadsToAll) {
  const fs::path first = kRoot / "docs/README.md";
  std::set<fs::path> led_to{first, kRoot / "README.md"};
  for (const auto& link : links_of(first)) {
    led_to.insert(link.first);
  }
  for (const fs::path& page : pages()) {
    EXPECT_TRUE(led_to.contains(page)) << first << " does not lead to " << page;
  }
}

TEST(Documents, WhatIsNotThereIsTold) {
  EXPECT_EQ(test_in("Suite.Name"), "Suite.Name");
  EXPECT_EQ(test_in("…Name"), "Name");
  EXPECT_EQ(test_in("README.txt"), "");
  EXPECT_EQ(anchor_of("Exit status, for scripts"), "exit-status-for-scripts");
  EXPECT_TRUE(is_source("core/mesh.h"));
  EXPECT_FALSE(is_source("mesh.h"));
}

}  // namespace
