// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdio>
#include <string>

namespace dubsar {

/// Holds a bench's figures against what is asked of them. What is missed gets a line, and the bench status 1.
class Asked {
 public:
  void at_most(const std::string& what, double is, double limit, const char* unit) {
    if (!(is <= limit)) {
      std::printf("MISSED: %s is %g %s, asked at most %g\n", what.c_str(), is, unit, limit);
      missed_ = true;
    }
  }
  /// What could not be measured at all.
  void nothing_of(const std::string& what) {
    std::printf("MISSED: %s could not be measured\n", what.c_str());
    missed_ = true;
  }
  [[nodiscard]] int status() const { return missed_ ? 1 : 0; }

 private:
  bool missed_ = false;
};

}  // namespace dubsar
