// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/big_array.h"
#include "core/parallel.h"

namespace dubsar {

/// Items [0, count) put into buckets, ascending within each: a counting sort in parallel.
struct Buckets {
  std::vector<std::uint32_t> start;  ///< [buckets + 1], into item
  BigArray<std::uint32_t> item;
};

/// key(i) in [0, buckets), or buckets and above: the item is left out.
template <class Key>
[[nodiscard]] Buckets make_buckets(std::size_t count, std::size_t buckets, const Key& key) {
  constexpr std::size_t kGrain = 1U << 16U;
  const std::size_t chunks = (count + kGrain - 1) / kGrain;
  std::vector<std::vector<std::uint32_t>> place(chunks);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> counts(buckets + 1, 0);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = key(i);
      ++counts[k < buckets ? k : buckets];
    }
    place[begin / kGrain] = std::move(counts);
  });
  Buckets result;
  result.start.assign(buckets + 1, 0);
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < buckets; ++k) {
    result.start[k] = sum;
    for (auto& counts : place) {
      const std::uint32_t here = counts[k];
      counts[k] = sum;
      sum += here;
    }
  }
  result.start[buckets] = sum;
  result.item = BigArray<std::uint32_t>(sum);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& next = place[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = key(i);
      if (k < buckets) {
        result.item[next[k]++] = static_cast<std::uint32_t>(i);
      }
    }
  });
  return result;
}

}  // namespace dubsar
