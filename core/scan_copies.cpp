// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/scan_copies.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/parallel.h"
#include "core/random.h"

namespace dubsar {

namespace {

struct Part {
  SampleDigest digest;
  std::size_t samples = 0;
};

std::uint64_t pair_of(std::uint32_t low, std::uint32_t high) {
  return std::uint64_t{high} << 32U | low;
}

void take(SampleDigest& into, std::uint64_t across, std::uint64_t along) {
  into.across = seed_for(into.across, across);
  into.along = seed_for(into.along, along);
}

}  // namespace

std::optional<SampleDigest> sample_digest(const RangeGrid& grid) {
  constexpr std::size_t kGrain = 16384;
  Part all = parallel_reduce_ordered(
      grid.size(), kGrain, Part{},
      [&](std::size_t begin, std::size_t end) {
        Part part;
        for (std::size_t i = begin; i < end; ++i) {
          if (grid.valid[i] != 0) {
            take(part.digest,
                 pair_of(std::bit_cast<std::uint32_t>(grid.x[i]), std::bit_cast<std::uint32_t>(grid.y[i])),
                 pair_of(std::bit_cast<std::uint32_t>(grid.z[i]), static_cast<std::uint32_t>(i)));
            ++part.samples;
          }
        }
        return part;
      },
      [](Part& total, const Part& part) {
        take(total.digest, part.digest.across, part.digest.along);
        total.samples += part.samples;
      });
  take(all.digest, static_cast<std::uint64_t>(grid.rows), static_cast<std::uint64_t>(grid.cols));
  return all.samples == 0 ? std::nullopt : std::optional(all.digest);
}

std::vector<ScanCopy> copies_among(const std::map<int, std::optional<SampleDigest>>& samples) {
  std::map<SampleDigest, int> first_with;
  std::vector<ScanCopy> copies;
  for (const auto& [id, digest] : samples) {
    if (!digest) {
      continue;
    }
    if (const auto [first, is_new] = first_with.try_emplace(*digest, id); !is_new) {
      copies.push_back({id, first->second});
    }
  }
  return copies;
}

std::vector<ScanCopy> copies_among(std::span<const PlacedScan> scans) {
  std::map<int, std::optional<SampleDigest>> samples;
  for (const PlacedScan& scan : scans) {
    samples[scan.id] = sample_digest(*scan.grid);
  }
  return copies_among(samples);
}

}  // namespace dubsar
