// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace dubsar {

/// The shortest text that reads back to the same double.
[[nodiscard]] inline std::string number_text(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

/// Appends text that reads back to the same float even when it is read as a double first: nine digits lie
/// well inside the float's interval, where the shortest text may lie at its border.
inline void append_number(std::string& to, float value) {
  std::array<char, 32> text;
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9);
  to.append(text.data(), end);
}

}  // namespace dubsar
