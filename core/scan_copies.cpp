// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/scan_copies.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <tuple>

#include "core/parallel.h"
#include "core/random.h"
#include "core/same_marks.h"

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

/// So many times the rounding of one coordinate the marks of a copy may lie elsewhere in the same frame: a
/// motion that is fitted to a few of them is not exact.
constexpr double kSamePlaceOfRounding = 8.0;

bool is_less(const ScanPrint& a, const ScanPrint& b) {
  return std::tie(a.samples, a.digest) < std::tie(b.samples, b.digest);
}

/// Of the one that is less to the other: told the same whichever is given first.
std::optional<RigidTransform> motion_between(const ScanPrint& a, const ScanPrint& b) {
  const bool a_is_part = is_less(a, b);
  return whole_from_part((a_is_part ? b : a).marks, (a_is_part ? a : b).marks);
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

std::optional<ScanPrint> scan_print(const RangeGrid& grid) {
  const std::optional<SampleDigest> digest = sample_digest(grid);
  return digest ? std::optional(ScanPrint{*digest, grid.valid_count(), scan_marks(grid)}) : std::nullopt;
}

bool are_copies(const ScanPrint& a, const ScanPrint& b) {
  return a.digest == b.digest || motion_between(a, b).has_value();
}

std::optional<RigidTransform> copy_motion(const ScanPrint& a, const ScanPrint& b) {
  if (a.digest == b.digest) {
    return RigidTransform{};
  }
  std::optional<RigidTransform> motion = motion_between(a, b);
  if (motion && is_less(a, b)) {
    motion = motion->inverse();
  }
  const bool in_place = motion && std::ranges::all_of(b.marks.marks, [&](const ScanMark& mark) {
                          const Eigen::Vector3d at = mark.at_mm.cast<double>();
                          return (*motion * at - at).norm() <= kSamePlaceOfRounding * a.marks.rounding_mm;
                        });
  return in_place ? RigidTransform{} : motion;
}

bool is_part(const ScanPrint& part, const ScanPrint& whole) {
  /// Points that are put into rows and columns anew lose up to a sixth.
  constexpr double kLeastPart = 0.8;
  return static_cast<double>(part.samples) < kLeastPart * static_cast<double>(whole.samples);
}

void KnownPrints::add(int id, std::optional<ScanPrint> print) {
  remove(id);
  if (!print) {
    return;
  }
  std::vector<std::pair<int, const ScanPrint*>> others;
  others.reserve(prints_.size());
  for (const auto& [other, known] : prints_) {
    others.emplace_back(other, &known);
  }
  std::vector<std::uint8_t> same(others.size(), 0);
  parallel_for_each_index(
      others.size(), [&](std::size_t k) { same[k] = are_copies(*print, *others[k].second) ? 1 : 0; }, 1);
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (same[k] != 0) {
      same_.insert(std::minmax({id, others[k].first}));
    }
  }
  prints_.emplace(id, std::move(*print));
}

void KnownPrints::remove(int id) {
  if (prints_.erase(id) > 0) {
    std::erase_if(same_, [id](const auto& pair) { return pair.first == id || pair.second == id; });
  }
}

void KnownPrints::clear() {
  prints_.clear();
  same_.clear();
}

std::vector<ScanCopy> KnownPrints::copies() const {
  std::set<int> all;
  for (const auto& [id, print] : prints_) {
    all.insert(id);
  }
  return copies_among(std::move(all));
}

std::vector<ScanCopy> KnownPrints::copies_among(std::set<int> ids) const {
  std::erase_if(ids, [this](int id) { return !prints_.contains(id); });
  std::vector<int> most_first(ids.begin(), ids.end());
  std::ranges::stable_sort(most_first, std::greater{}, [this](int id) { return prints_.at(id).samples; });
  std::vector<int> count;
  std::vector<ScanCopy> copies;
  for (const int id : most_first) {
    const auto first = std::ranges::find_if(count, [&](int other) {
      return same_.contains(std::minmax({id, other}));
    });
    if (first == count.end()) {
      count.push_back(id);
    } else {
      copies.push_back({id, *first});
    }
  }
  std::ranges::sort(copies);
  return copies;
}

std::vector<ScanCopy> copies_among(std::span<const PlacedScan> scans) {
  KnownPrints known;
  for (const PlacedScan& scan : scans) {
    known.add(scan.id, scan_print(*scan.grid));
  }
  return known.copies();
}

}  // namespace dubsar
