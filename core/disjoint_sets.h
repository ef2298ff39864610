// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace dubsar {

/// Union-find over 0 … size-1 that several threads may unite in at once, without a lock: a root is only ever
/// linked to a smaller one, so that in the end each set's root is its least member, whoever came first.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    parallel_for_each_index(
        size, [&](std::size_t i) { parent_[i] = static_cast<std::uint32_t>(i); }, 65536);
  }

  /// The least member of i's set, once no thread unites any more; before, one that is on the way to it.
  [[nodiscard]] std::uint32_t root(std::uint32_t i) {
    for (;;) {
      const std::uint32_t up = at(i).load(std::memory_order_relaxed);
      if (up == i) {
        return i;
      }
      const std::uint32_t above = at(up).load(std::memory_order_relaxed);
      at(i).store(above, std::memory_order_relaxed);  // an ancestor, whatever others write meanwhile
      i = above;
    }
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) {
        return;
      }
      if (a < b) {
        std::swap(a, b);
      }
      std::uint32_t expected = a;
      if (at(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) {
        return;
      }
    }
  }

 private:
  [[nodiscard]] std::atomic_ref<std::uint32_t> at(std::uint32_t i) {
    return std::atomic_ref<std::uint32_t>(parent_[i]);
  }

  std::vector<std::uint32_t> parent_;
};

}  // namespace dubsar
