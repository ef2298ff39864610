// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/mesh.h"

namespace dubsar::testing {

/// The smallest closed mesh, with numbers that no short decimal tells.
[[nodiscard]] inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{1.0F / 3, 0, 0}, {10, 1e-7F, 0}, {0, 12345.678F, 0}, {0, 0, -7.7F}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

}  // namespace dubsar::testing
