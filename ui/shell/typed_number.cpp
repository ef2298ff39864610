// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/typed_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace dubsar::ui {

std::optional<double> typed_number(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) {
    return std::nullopt;
  }
  std::string number = text.substr(first, text.find_last_not_of(" \t") + 1 - first);
  std::ranges::replace(number, ',', '.');
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  const bool all = error == std::errc() && end == number.data() + number.size() && std::isfinite(value);
  return all ? std::optional(value) : std::nullopt;
}

}  // namespace dubsar::ui
