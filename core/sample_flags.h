// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar {

/// State bits of one sample (seed 001, 3.3). A sample is red while it is sparse and neither cleared nor
/// excused.
enum SampleFlag : std::uint8_t {
  kPotentiallySparse = 1,  ///< an X or Y neighbour is missing or farther than 3µ on the surface
  kSparse = 2,             ///< more than half of its eight surrounding cells are potentially sparse
  kCleared = 4,            ///< matches a non-flagged sample of another scan
  kExcused = 8,            ///< shown unreachable or unneeded
  kNotTablet = 16,         ///< a pin, an arm or other scenery: nothing to scan, nothing to mesh
};

/// One byte of SampleFlag bits per cell of a grid, row major; invalid cells hold 0.
using SampleFlags = std::vector<std::uint8_t>;

[[nodiscard]] constexpr bool is_red(std::uint8_t flags) {
  return (flags & kSparse) != 0 && (flags & (kCleared | kExcused | kNotTablet)) == 0;
}
/// A sample whose neighbourhood was well sampled by its own scan: may clear others and carry triangles.
[[nodiscard]] constexpr bool is_unflagged(std::uint8_t flags) {
  return (flags & (kSparse | kNotTablet)) == 0;
}

}  // namespace dubsar
