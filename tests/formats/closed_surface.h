// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "core/mesh.h"

namespace dubsar::testing {

/// Every edge of a closed oriented surface stands once each way.
inline bool is_closed_and_oriented(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{f[k], f[(k + 1) % 3]}];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end()) {
      return false;
    }
  }
  return !edges.empty();
}

}  // namespace dubsar::testing
