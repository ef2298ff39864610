// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/types.h>

#include <string>

namespace dubsar::test {

/// A display without a screen (Xvfb) for the commands that a test runs; DISPLAY names it until it goes.
class Display {
 public:
  explicit Display(const std::string& size = "1366x768x24", bool with_opengl = true);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  /// False when there is no Xvfb here.
  [[nodiscard]] bool works() const { return number_ >= 0; }

 private:
  pid_t pid_ = -1;
  int number_ = -1;
};

}  // namespace dubsar::test
