// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace dubsar {

struct StageTiming {
  std::string stage;
  double seconds = 0;
};

/// In the order of the work.
using StageTimes = std::vector<StageTiming>;

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Notes how long each stage took, each beginning where the one before it was done; nothing without a list.
class LapClock {
 public:
  explicit LapClock(StageTimes* times) : times_(times) {}

  void done(const char* stage) {
    if (times_ != nullptr) {
      times_->push_back({stage, seconds_since(start_)});
    }
    start_ = std::chrono::steady_clock::now();
  }

 private:
  StageTimes* times_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace dubsar
