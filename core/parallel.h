// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/chunk_loop.h"

namespace dubsar {

/// Calls body(begin, end) over chunks of [0, count) of `grain` items each. The chunks depend on count and
/// grain only, never on the number of threads, so that work done per chunk gives the same bytes on every
/// machine.
template <class Body>
void parallel_chunks(std::size_t count, std::size_t grain, const Body& body) {
  const std::size_t chunks = (count + grain - 1) / grain;
  for_each_chunk(chunks, [&](std::size_t chunk) {
    const std::size_t begin = chunk * grain;
    body(begin, begin + grain < count ? begin + grain : count);
  });
}

/// Calls body(i) for each i in [0, count). Each i must write to places of its own.
template <class Body>
void parallel_for_each_index(std::size_t count, const Body& body, std::size_t grain = 256) {
  parallel_chunks(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      body(i);
    }
  });
}

/// Calls body(begin, end) for ranges of [0, count), about one for each thread: for work that has to go
/// through all of something for every range (what scatters into it). Where the ranges end must not show in
/// what comes out.
template <class Body>
void parallel_ranges(std::size_t count, const Body& body) {
  constexpr std::size_t kLeast = std::size_t{1}
                                 << 18U;  // below, going through all twice costs more than it saves
  constexpr std::size_t kMost = 8;
  const std::size_t ranges = std::clamp(count / kLeast, std::size_t{1}, std::min(kMost, chunks_at_once()));
  if (ranges == 1) {
    body(std::size_t{0}, count);
  } else {
    for_each_chunk(ranges, [&](std::size_t k) { body(count * k / ranges, count * (k + 1) / ranges); });
  }
}

/// Reduces chunk results in chunk order, so that floating-point sums do not depend on the number of threads.
/// map(begin, end) -> T; join(T& into, const T& chunk).
template <class T, class Map, class Join>
T parallel_reduce_ordered(std::size_t count, std::size_t grain, T identity, const Map& map,
                          const Join& join) {
  const std::size_t chunks = (count + grain - 1) / grain;
  std::vector<T> partial(chunks, identity);
  for_each_chunk(chunks, [&](std::size_t chunk) {
    const std::size_t begin = chunk * grain;
    partial[chunk] = map(begin, begin + grain < count ? begin + grain : count);
  });
  T total = identity;
  for (const T& part : partial) {
    join(total, part);
  }
  return total;
}

}  // namespace dubsar
