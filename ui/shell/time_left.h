// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

namespace dubsar::ui {

/// How long what a job is at will take still, told from how long its part so far has taken.
class TimeLeft {
 public:
  /// Seconds; nothing while it is too early to tell. A stage with another name begins anew, and so does one
  /// that has gone back.
  [[nodiscard]] std::optional<double> of(const std::string& stage, double fraction, double now_s);

 private:
  std::string stage_;
  double began_s_ = 0;
  double fraction_ = 0;
};

}  // namespace dubsar::ui
