// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "formats/atomic_file.h"

namespace dubsar::test {

/// Writes a file, and the folders that it lies in.
inline void put(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string text_of_file(const std::filesystem::path& path) {
  return read_whole_file(path).value_or("cannot be read");
}

}  // namespace dubsar::test
