// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <string>

namespace dubsar::test {

/// Standard input of this process, and of the commands that it starts: a terminal at which the test types, or
/// none. What it was before comes back.
class TypedInput {
 public:
  enum class Kind { kTerminal, kNone };

  explicit TypedInput(Kind kind) {
    int input = -1;
    if (kind == Kind::kTerminal) {
      keyboard_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
      ::grantpt(keyboard_);
      ::unlockpt(keyboard_);
      input = ::open(::ptsname(keyboard_), O_RDWR | O_NOCTTY | O_CLOEXEC);
      termios silent{};
      ::tcgetattr(input, &silent);
      silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);  // which nobody reads
      ::tcsetattr(input, TCSANOW, &silent);
    } else {
      input = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    }
    ::dup2(input, STDIN_FILENO);
    ::close(input);
  }
  ~TypedInput() {
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
    if (keyboard_ >= 0) {
      ::close(keyboard_);
    }
  }
  TypedInput(const TypedInput&) = delete;
  TypedInput& operator=(const TypedInput&) = delete;

  /// False where the terminal takes no more.
  [[nodiscard]] bool type(const std::string& text) const {
    return ::write(keyboard_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  }

 private:
  int before_ = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  int keyboard_ = -1;
};

}  // namespace dubsar::test
