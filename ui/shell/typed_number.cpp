// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/typed_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace dubsar::ui {

namespace {

/// Without the blanks around it, a comma as a point.
std::string with_point(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) {
    return {};
  }
  std::string number = text.substr(first, text.find_last_not_of(" \t") + 1 - first);
  std::ranges::replace(number, ',', '.');
  return number;
}

}  // namespace

std::optional<double> typed_number(const std::string& text) {
  const std::string number = with_point(text);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  const bool all = error == std::errc() && end == number.data() + number.size() && std::isfinite(value);
  return all ? std::optional(value) : std::nullopt;
}

std::string number_word(const std::string& text) {
  return typed_number(text) ? with_point(text) : text;
}

}  // namespace dubsar::ui
