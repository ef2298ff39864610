// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <compare>
#include <optional>
#include <span>

namespace dubsar {

/// A scan with the very samples of another, such as a file that came twice, in whatever form: rounded,
/// turned, cut or in another frame (scan_copies.h). No two scans have the same noise: they are one
/// measurement, wherever their poses put it, and are to count as one.
struct ScanCopy {
  int id = 0;
  int of_id = 0;  ///< the one that counts: with the most of these samples, of equals the lowest

  auto operator<=>(const ScanCopy&) const = default;
};

/// The scan that this one is a copy of; nothing where it is none.
[[nodiscard]] inline std::optional<int> copied_from(std::span<const ScanCopy> copies, int id) {
  const auto copy = std::ranges::find(copies, id, &ScanCopy::id);
  return copy == copies.end() ? std::nullopt : std::optional(copy->of_id);
}

}  // namespace dubsar
