// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <clocale>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "tests/support/temporary_folder.h"

namespace dubsar::test {

/// The decimal comma of a host program's locale, as long as this lives. Few machines have a locale with one
/// installed: it is made of C.utf8's table of numbers, a small file of glibc's.
class CommaLocale {
 public:
  CommaLocale() {
    std::ifstream in("/usr/lib/locale/C.utf8/LC_NUMERIC", std::ios::binary);
    std::string table{std::istreambuf_iterator<char>(in), {}};
    const std::size_t point = table.find(std::string(".\0", 2));
    const std::size_t wide_point = table.find(std::string(".\0\0\0", 4), point + 1);
    if (point == std::string::npos || wide_point == std::string::npos) {
      return;
    }
    table[point] = table[wide_point] = ',';
    std::filesystem::create_directory(folder_.path() / "xx_XX");
    std::ofstream(folder_.path() / "xx_XX" / "LC_NUMERIC", std::ios::binary) << table;
    if (const char* path = std::getenv("LOCPATH")) {
      path_before_ = path;
    }
    ::setenv("LOCPATH", folder_.path().c_str(), 1);
    (void)std::setlocale(LC_NUMERIC, "xx_XX");
  }
  ~CommaLocale() {
    (void)std::setlocale(LC_NUMERIC, "C");
    if (path_before_) {
      ::setenv("LOCPATH", path_before_->c_str(), 1);
    } else {
      ::unsetenv("LOCPATH");
    }
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  /// False where there is no such table: then the test has nothing to say.
  [[nodiscard]] static bool is_set() { return *std::localeconv()->decimal_point == ','; }

 private:
  TemporaryFolder folder_;
  std::optional<std::string> path_before_;
};

}  // namespace dubsar::test
