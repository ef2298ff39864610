// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <string>
#include <vector>

namespace dubsar {

/// What is to be said of many files one after the other. What differs in its numbers alone is said of the
/// first file and, in one line at the end, of all others.
class AlikeRemarks {
 public:
  /// The line to say now; empty where the same was said of another file.
  [[nodiscard]] std::string add(const std::string& file, const std::string& remark);
  /// The lines to say at the end.
  [[nodiscard]] std::vector<std::string> rest() const;

 private:
  struct Alike {
    std::string file;                 ///< the first
    std::vector<std::string> others;  ///< files
    std::string second;               ///< what is said of the first of these
  };
  std::map<std::string, Alike> alike_;  ///< by what is left without the numbers
};

}  // namespace dubsar
