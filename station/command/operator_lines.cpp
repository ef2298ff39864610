// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/operator_lines.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <utility>

namespace dubsar {

OperatorLines::OperatorLines(std::function<bool()> is_over) : is_over_(std::move(is_over)) {}

bool OperatorLines::has_terminal() {
  return ::isatty(STDIN_FILENO) != 0;
}

void OperatorLines::forget() {
  pending_.clear();
  ::tcflush(STDIN_FILENO, TCIFLUSH);
}

std::optional<std::string> OperatorLines::next() {
  for (;;) {
    if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
      std::string out = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      return out;
    }
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    if (is_over_()) {
      return std::nullopt;
    }
    if (::poll(&waiting, 1, 200) <= 0) {
      continue;
    }
    char bytes[256];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (got <= 0) {
      return std::nullopt;
    }
    pending_.append(bytes, static_cast<std::size_t>(got));
  }
}

}  // namespace dubsar
