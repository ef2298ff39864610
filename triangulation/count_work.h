// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <functional>

namespace dubsar {

/// What a search does goes by how often it holds one box, or cell, against another. Called from several
/// threads, with how often since the last call; empty: nobody counts.
using CountWork = std::function<void(std::size_t comparisons)>;

inline void count_work(const CountWork& counted, std::size_t comparisons) {
  if (counted && comparisons > 0) {
    counted(comparisons);
  }
}

}  // namespace dubsar
