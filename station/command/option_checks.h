// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string>
#include <type_traits>

#include "core/utf8.h"

/// What the values of options are held against. No number with a point is left to CLI::Range: "nan" is
/// neither below nor above any limit, and passes it.
namespace dubsar {

/// A finite number from `low` to `high`, both included.
template <class T>
[[nodiscard]] CLI::Validator in_range(T low, T high) {
  const CLI::Range range(low, high);
  return CLI::Validator(
      [range](std::string& text) {
        double value = 0;
        const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        if (!is_number) {
          return "'" + text + "' is no number";
        }
        if (std::is_integral_v<T> && value != std::floor(value)) {
          return "'" + text + "' is no whole number";
        }
        return range(text);
      },
      range.get_description());
}

/// The number of a scan or a wedge, or a seed. CLI reads an unsigned "-1" as 18446744073709551615, and
/// CLI::NonNegativeNumber tells the upper limit in 309 digits.
[[nodiscard]] inline CLI::Validator not_negative() {
  return CLI::Validator(
      [](std::string& text) { return text.starts_with('-') ? "'" + text + "' is below 0" : std::string(); },
      "NONNEGATIVE");
}

/// Text that is shown and kept: what is no UTF-8 would be kept as question marks.
[[nodiscard]] inline CLI::Validator readable() {
  return CLI::Validator(
      [](std::string& text) {
        return is_utf8(text) ? std::string()
                             : std::string("has bytes that are no UTF-8; set the terminal to UTF-8");
      },
      "");
}

/// Text of one line: a name or a reason. Lists show many of them, and a terminal obeys control characters.
[[nodiscard]] inline CLI::Validator single_line() {
  return CLI::Validator(
      [](std::string& text) {
        return is_one_line(text) ? std::string()
                                 : std::string("has control characters, such as a line break");
      },
      "");
}

/// The name of a file that is written in one form only; a device has no form.
[[nodiscard]] inline CLI::Validator ends_as(const std::string& ending) {
  return CLI::Validator(
      [ending](std::string& name) {
        std::string own = std::filesystem::path(name).extension().string();
        std::ranges::transform(own, own.begin(), [](unsigned char c) { return std::tolower(c); });
        return own == ending || name.starts_with("/dev/") ? std::string()
                                                          : "'" + name + "' does not end in " + ending;
      },
      "");
}

/// The type of an option whose empty text means something; all others refuse it (main.cpp).
inline constexpr const char* kMayBeEmpty = "TEXT or \"\"";

}  // namespace dubsar
