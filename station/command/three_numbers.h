// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <charconv>
#include <optional>
#include <string_view>

namespace dubsar {

/// "50x40x20" or "1,2.5,3": nothing but three numbers with `separator` between them.
[[nodiscard]] inline std::optional<Eigen::Vector3d> three_numbers(std::string_view text, char separator) {
  Eigen::Vector3d out;
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (int k = 0; k < 3; ++k) {
    const auto [next, error] = std::from_chars(at, end, out[k]);
    const bool parted = k == 2 ? next == end : next != end && *next == separator;
    if (error != std::errc() || !parted) {
      return std::nullopt;
    }
    at = next + (k < 2 ? 1 : 0);
  }
  return out;
}

}  // namespace dubsar
