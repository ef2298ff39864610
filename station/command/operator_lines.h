// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace dubsar {

/// What the operator types, line by line, of a verb that waits for a word.
class OperatorLines {
 public:
  /// `is_over`: nobody waits for a line any more. Asked several times a second, on the thread of next().
  explicit OperatorLines(std::function<bool()> is_over);

  /// Whether somebody can be asked: standard input is a terminal.
  [[nodiscard]] static bool has_terminal();

  /// What was typed until now is no answer to what is asked next. Of a terminal alone.
  void forget();

  /// The next line, without its end; nothing at the end of the input, or when it is over.
  [[nodiscard]] std::optional<std::string> next();

 private:
  std::function<bool()> is_over_;
  std::string pending_;
};

}  // namespace dubsar
