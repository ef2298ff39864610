// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

/// Other people's programs, which files are held against.
namespace dubsar::test {

/// The exit status; what it says goes to standard error. -1 when a signal ended it.
inline int shell(const std::string& command) {
  const int status = std::system((command + " >&2").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null").c_str()) == 0;
}

inline std::string quoted(const std::filesystem::path& path) {
  std::string out = path.string();
  out.insert(out.begin(), '\'');
  out.push_back('\'');
  return out;
}

}  // namespace dubsar::test
