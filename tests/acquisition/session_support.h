// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "core/random.h"
#include "core/range_grid.h"

namespace dubsar::test {

/// A grid of a few thousand samples whose content follows from its number.
inline RangeGrid small_grid(int number) {
  RangeGrid grid;
  grid.allocate(40 + number % 7, 50);
  Random random(static_cast<std::uint64_t>(number) + 1);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = random.uniform() < 0.9 ? 1 : 0;
    if (grid.valid[i] != 0) {
      grid.x[i] = 0.1F * static_cast<float>(grid.col_of(i));
      grid.y[i] = 0.1F * static_cast<float>(grid.row_of(i));
      grid.z[i] = static_cast<float>(random.normal());
    }
  }
  grid.spacing_mm = 0.1;
  grid.source = "made " + std::to_string(number);
  return grid;
}

/// Inverts bits of one byte of a file.
inline void flip_byte(const std::filesystem::path& path, std::uintmax_t at, int mask = 0xff) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(static_cast<std::streamoff>(at));
  const char byte = static_cast<char>(file.get() ^ mask);
  file.seekp(static_cast<std::streamoff>(at));
  file.put(byte);
}

}  // namespace dubsar::test
