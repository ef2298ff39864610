// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What docs/developers/libraries.md says that a component brings in against what its CMakeLists.txt asks for.

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "build_paths.h"

namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// libpng, PNG: png; Eigen, Eigen3: eigen.
std::string plain(std::string name) {
  for (char& c : name) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  name = name.starts_with("lib") ? name.substr(3) : name;
  while (name.ends_with('2') || name.ends_with('3')) {
    name.pop_back();
  }
  return name;
}

Names found_in(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  Names names;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) {
    names.insert(plain((*it)[1]));
  }
  return names;
}

/// Component -> what the third column of the table says.
std::map<std::string, std::string> told() {
  std::map<std::string, std::string> rows;
  std::istringstream in(text_of(fs::path(DUBSAR_SOURCE_DIR) / "docs/developers/libraries.md"));
  static const std::regex kRow(R"(^\| `([a-z]+)` \|[^|]*\|([^|]*)\|\s*$)");
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kRow)) {
      rows[match[1]] = match[2];
    }
  }
  return rows;
}

TEST(Libraries, BringInWhatTheirPageSays) {
  const auto rows = told();
  ASSERT_EQ(rows.size(), 11U);
  for (const auto& [component, row] : rows) {
    std::string cmake = text_of(fs::path(DUBSAR_SOURCE_DIR) / component / "CMakeLists.txt");
    const std::size_t from = cmake.find("dubsar_library(" + component);
    ASSERT_NE(from, std::string::npos) << component;
    cmake = cmake.substr(from, cmake.find("\n\n", from) - from);
    const std::string others = std::regex_replace(row, std::regex("`[^`]*`|all of the above"), "");
    EXPECT_EQ(found_in(others, "([A-Za-z_0-9]+)"),
              found_in(cmake, R"((?:find_dependency|dubsar_pkg)\((\w+))"))
        << component;
    if (row.find("all of the above") == std::string::npos) {
      EXPECT_EQ(found_in(row, "`([a-z]+)`"), found_in(cmake, R"(\bdubsar_(?!library|pkg)([a-z]+)\b)"))
          << component;
    }
  }
}

}  // namespace
