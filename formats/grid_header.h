// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// Which optional parts a grid file holds.
enum GridFilePart : std::uint32_t {
  kGridHasLaser = 1,
  kGridHasCamera = 2,
  kGridHasNominal = 4,
  kGridHasIntensity = 8,
  kGridHasConfidence = 16,
  kGridHasColour = 32,
};

/// The header of the own grid file: everything but the samples. `grid` has no samples yet.
struct GridHeader {
  RangeGrid grid;
  std::uint32_t parts = 0;
  std::uint64_t valid_count = 0;
  std::uint64_t file_bytes = 0;
  std::vector<std::uint64_t> chunk_bytes;  ///< of each chunk behind the header, in file order
  std::size_t header_bytes = 0;
};

/// How many bytes of every grid file come before anything that the version may change: magic, version, length
/// of the header, length of the file.
inline constexpr std::size_t kGridPreludeBytes = 8 + 4 + 4 + 8;
inline constexpr std::size_t kGridChecksumBytes = 8;

[[nodiscard]] std::string encode_grid_header(const GridHeader& header);
/// Magic, version, the file's length and that of the header.
[[nodiscard]] Status check_grid_prelude(std::string_view file, const std::string& where);
/// Checks the prelude and every length against the bytes that are there.
[[nodiscard]] Result<GridHeader> decode_grid_header(std::string_view file, const std::string& where);

}  // namespace dubsar
