// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dubsar {

/// The chunk coding of the own grid file (docs/formats/grid.md): values become differences to their
/// predecessor, their bytes are sorted by significance, and zstd packs the rest. Lossless for every bit
/// pattern.
[[nodiscard]] std::string pack_floats(std::span<const float> values);
/// False when the bytes do not hold exactly `values.size()` floats.
[[nodiscard]] bool unpack_floats(std::string_view packed, std::span<float> values);

/// Colours, three interleaved bytes a sample.
[[nodiscard]] std::string pack_bytes(std::span<const std::uint8_t> values);
[[nodiscard]] bool unpack_bytes(std::string_view packed, std::span<std::uint8_t> values);

}  // namespace dubsar
