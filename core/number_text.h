// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

/// Numbers as text with a point, whatever locale a host program has set: printf, std::to_string of a double
/// and strtod follow LC_NUMERIC, and a stage that is told to go to "1,5" goes to 1.
namespace dubsar {

/// The shortest text that reads back to the same double.
[[nodiscard]] inline std::string number_text(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

/// With so many decimals (0 to 60), as printf's %.2f.
[[nodiscard]] inline std::string fixed_text(double value, int decimals) {
  std::array<char, 400> text;  // the largest double has 309 digits before the point
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals);
  return {text.data(), end};
}

/// With at most so many significant digits (1 to 17), as printf's %g.
[[nodiscard]] inline std::string short_text(double value, int digits = 6) {
  std::array<char, 32> text;
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), end};
}

/// "1 wedge", "3 wedges", "0 wedges": for people.
[[nodiscard]] inline std::string counted(std::size_t count, std::string_view one) {
  return std::to_string(count).append(" ").append(one).append(count == 1 ? "" : "s");
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
