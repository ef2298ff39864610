// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dubsar {

/// Keys of cells of space (open addressing).
class CellSet {
 public:
  /// most: keys that are put in at the most.
  explicit CellSet(std::size_t most) : mask_(std::bit_ceil(2 * most + 16) - 1), keys_(mask_ + 1, 0) {}
  /// False when the key was there.
  bool insert(std::uint64_t key) {
    std::uint64_t& place = keys_[place_of(++key)];
    const bool is_new = place == 0;
    place = key;
    return is_new;
  }
  [[nodiscard]] bool contains(std::uint64_t key) const { return keys_[place_of(++key)] != 0; }

 private:
  /// Of a key that is not 0, which stands for an empty place: where it is, or may be put.
  [[nodiscard]] std::size_t place_of(std::uint64_t key) const {
    const std::uint64_t h = key * 0x9E3779B97F4A7C15ULL;
    std::size_t at = (h >> 20U) & mask_;
    while (keys_[at] != 0 && keys_[at] != key) {
      at = (at + 1) & mask_;
    }
    return at;
  }

  std::size_t mask_;
  std::vector<std::uint64_t> keys_;
};

}  // namespace dubsar
