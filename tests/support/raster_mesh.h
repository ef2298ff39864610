// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

#include "core/mesh.h"

namespace dubsar::test {

/// Two faces for each of cells × cells, over vertices that lie row by row from `first` on, cells + 1 a row.
inline void add_raster_faces(Mesh& mesh, std::uint32_t first, std::uint32_t cells) {
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = first + y * (cells + 1) + x;
      mesh.faces.push_back({a, a + 1, a + cells + 1});
      mesh.faces.push_back({a + 1, a + cells + 2, a + cells + 1});
    }
  }
}

/// A square of 1 mm in a plane: there is no wedge in it.
inline Mesh blank_square() {
  Mesh mesh;
  for (int v = 0; v < 4; ++v) {
    mesh.positions.emplace_back(static_cast<float>(v % 2), static_cast<float>(v / 2), 0.0F);
  }
  add_raster_faces(mesh, 0, 1);
  return mesh;
}

}  // namespace dubsar::test
