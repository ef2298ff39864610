// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitch_entry.h"

#include <cstddef>

#include "core/parallel.h"

namespace dubsar {

std::vector<std::uint32_t> unfused(const Entry& entry) {
  using Samples = std::vector<std::uint32_t>;
  const Lattice& lattice = entry.surface.lattice;
  return parallel_reduce_ordered(
      lattice.size(), 1024, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        for (std::size_t node = begin; node < end; ++node) {
          lattice.for_each_sample(node, [&](std::size_t i) {
            if (entry.wanted[i] != 0 && entry.fused.slot[i] == FusedSamples::kNone) {
              found.push_back(static_cast<std::uint32_t>(i));
            }
          });
        }
        return found;
      },
      [](Samples& total, const Samples& part) { total.insert(total.end(), part.begin(), part.end()); });
}

}  // namespace dubsar
