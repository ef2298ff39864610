// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Every #include of the project against the table of layers in docs/architecture.md.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "build_paths.h"

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = DUBSAR_SOURCE_DIR;

using Table = std::map<std::string, std::vector<std::string>>;  // folder -> prefixes that it may include

std::vector<std::string> quoted(const std::string& text) {
  static const std::regex kWord("`([^`]+)`");
  std::vector<std::string> words;
  for (std::sregex_iterator it(text.begin(), text.end(), kWord), end; it != end; ++it) {
    words.push_back((*it)[1]);
  }
  return words;
}

Table read_table() {
  Table table;
  std::ifstream in(kRoot / "docs/architecture.md");
  static const std::regex kRow(R"(^\| `([a-z_/]+/)` \|(.*)\|\s*$)");
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kRow)) {
      table[match[1]] = quoted(match[2]);
    }
  }
  return table;
}

/// The row of the table whose folder is the longest prefix of the path, or none.
Table::const_iterator row_for(const Table& table, const std::string& path) {
  auto best = table.end();
  for (auto it = table.begin(); it != table.end(); ++it) {
    if (path.starts_with(it->first) && (best == table.end() || it->first.size() > best->first.size())) {
      best = it;
    }
  }
  return best;
}

/// The first rule that this include breaks, or an empty text.
std::string broken_rule(const Table& table, const std::string& file, const std::string& included) {
  const auto from = row_for(table, file);
  const auto to = row_for(table, included);
  if (from == table.end() || to == table.end() || included.starts_with(from->first)) {
    return {};
  }
  for (const std::string& prefix : from->second) {
    const bool exact_folder = prefix.ends_with('/') && to->first == prefix;
    if (exact_folder || included == prefix) {
      return {};
    }
  }
  return file + " includes " + included + ": " + from->first + " may not";
}

TEST(Layers, TableHasTheFolders) {
  const Table table = read_table();
  EXPECT_TRUE(table.contains("core/"));
  EXPECT_TRUE(table.contains("station/"));
  EXPECT_TRUE(table.at("core/").empty());
}

TEST(Layers, TheRuleCanFail) {
  const Table table = read_table();
  EXPECT_FALSE(broken_rule(table, "core/mesh.h", "planning/red_map.h").empty());
  EXPECT_FALSE(broken_rule(table, "drivers/replay/replay.cpp", "drivers/loader.h").empty());
  EXPECT_TRUE(broken_rule(table, "drivers/replay/replay.cpp", "drivers/driver.h").empty());
  EXPECT_TRUE(broken_rule(table, "planning/red_map.h", "core/mesh.h").empty());
}

TEST(Layers, NoIncludePointsUp) {
  const Table table = read_table();
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)")re");
  int includes = 0;
  for (const auto& [folder, allowed] : table) {
    if (!fs::exists(kRoot / folder)) {
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".c") {
        continue;
      }
      const std::string file = fs::relative(entry.path(), kRoot).generic_string();
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (std::regex_search(line, match, kInclude)) {
          ++includes;
          EXPECT_EQ(broken_rule(table, file, match[1]), "");
        }
      }
    }
  }
  EXPECT_GT(includes, 20);
}

}  // namespace
