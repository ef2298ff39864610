// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// Dubsar's own grid file (docs/formats/grid.md): every field of a RangeGrid, lossless, compressed, with a
/// checksum over every byte. The same grid gives the same bytes. Cells that are not valid are not kept: they
/// read back as zeros.
inline constexpr std::string_view kGridMagic{
    "\x89"
    "DGRID\r\n",
    8};
inline constexpr std::uint32_t kGridVersion = 1;

/// The arrays of the grid must be as long as core/range_grid.h says.
[[nodiscard]] std::vector<std::byte> encode_grid(const RangeGrid& grid);

/// `where` stands in errors. Errors: not such a file, a newer version, cut short, a wrong checksum, sizes
/// that contradict each other. Takes no more memory than a fixed multiple of the bytes given.
[[nodiscard]] Result<RangeGrid> decode_grid(std::span<const std::byte> bytes, const std::string& where);

[[nodiscard]] Result<RangeGrid> read_grid_file(const std::filesystem::path& path);
/// Atomic and durable: see atomic_file.h.
[[nodiscard]] Status write_grid_file(const std::filesystem::path& path, const RangeGrid& grid);

/// Length and checksum only: whether the bytes are still the ones that were written.
[[nodiscard]] Status verify_grid_bytes(std::span<const std::byte> bytes, const std::string& where);
[[nodiscard]] Status verify_grid_file(const std::filesystem::path& path);

[[nodiscard]] bool is_grid_file(std::string_view head);

}  // namespace dubsar
