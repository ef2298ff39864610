// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "core/mesh.h"
#include "triangulation/self_intersections.h"

namespace dubsar::test {

/// How often boxes are held against each other until it is known that no face cuts another.
inline std::size_t comparisons_of(const Mesh& mesh) {
  std::atomic<std::size_t> comparisons{0};
  EXPECT_TRUE(self_intersections(mesh.positions, mesh.faces, {}, {}, [&](std::size_t more) {
                comparisons += more;
              }).empty());
  return comparisons;
}

}  // namespace dubsar::test
