// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/face_cells.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>

#include "core/huge_pages.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "triangulation/part_cells.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kGrain = 4096;
constexpr std::uint32_t kNone = 0xffffffffU;
constexpr unsigned kAxisBits = 29;
constexpr unsigned kLevelShift = 64 - 8;

Vector3d sizes_of(const Eigen::AlignedBox3f& box) {
  return box.max().cast<double>() - box.min().cast<double>();
}

/// The number of the cell along an axis that lies so many cells' widths from the origin, in the order of the
/// axis. Near the origin cells are as wide as they should be. Farther out floats come to have hardly a step
/// for each, and it goes by their leading digits, 20 bits of them: cells get wider, as those steps do, and
/// hold a few of them.
std::int64_t number_along_axis(double cells) {
  constexpr double kEven = 1U << 23U;
  constexpr unsigned kOtherDigits = 32;  // of the 52 of a double
  if (std::abs(cells) < kEven) {
    return static_cast<std::int64_t>(std::floor(cells));
  }
  const auto steps = static_cast<std::int64_t>(
      (std::bit_cast<std::uint64_t>(std::abs(cells)) - std::bit_cast<std::uint64_t>(kEven)) >> kOtherDigits);
  const std::int64_t beyond = static_cast<std::int64_t>(kEven) + steps;  // below 2^28: 232 powers of two
  return cells < 0 ? -1 - beyond : beyond;
}

}  // namespace

FaceCells::FaceCells(std::span<const Vector3f> positions, std::span<const std::array<std::uint32_t, 3>> faces,
                     const std::vector<std::uint32_t>& which, std::span<const std::uint32_t> part_of_face,
                     double smallest_mm, const JobContext& job) {
  for (int level = 0; level < kLevels; ++level) {
    cell_mm_[static_cast<std::size_t>(level)] = std::ldexp(smallest_mm, level);
  }
  resize_in_huge_pages(entries_, which.size());
  parallel_chunks(entries_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end && !job.cancelled(); ++k) {
      const Eigen::AlignedBox3f box = box_of(positions, faces[which[k]]);
      const int level = level_of(box);
      const Vector3d middle = 0.5 * (box.min().cast<double>() + box.max().cast<double>());
      const Key key = key_of(level, place_of(middle, level));
      entries_[k] = {key.upper, key.lower, which[k]};
    }
  });
  parallel_sort(entries_.begin(), entries_.end(), std::less<>{}, job);
  if (job.cancelled()) {
    return;
  }
  resize_in_huge_pages(boxes_, entries_.size());
  parts_.resize(part_of_face.empty() ? 0 : entries_.size());
  parallel_chunks(entries_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end && !job.cancelled(); ++k) {
      const std::uint32_t face = entries_[k].face;
      boxes_[k] = box_of(positions, faces[face]);
      if (!parts_.empty()) {
        parts_[k] = part_of_face[face];
      }
    }
  });
  if (!job.cancelled()) {
    lay_cells(job);
  }
}

void FaceCells::lay_cells(const JobContext& job) {
  for (std::size_t k = 0; k < entries_.size() && !job.cancelled(); ++k) {
    if (k == 0 || entries_[k].key() != entries_[k - 1].key()) {
      cells_.push_back({entries_[k].upper, entries_[k].lower, static_cast<std::uint32_t>(k), 0, 0, {}});
    }
  }
  parallel_chunks(cells_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end && !job.cancelled(); ++c) {
      Cell& cell = cells_[c];
      cell.end = c + 1 < cells_.size() ? cells_[c + 1].first : static_cast<std::uint32_t>(entries_.size());
      cell.part = part(cell.first);
      for (std::uint32_t k = cell.first; k < cell.end; ++k) {
        cell.part = part(k) == cell.part ? cell.part : 0;
        cell.box.extend(boxes_[k]);
      }
    }
  });
  for (std::size_t c = 0; c < cells_.size() && !job.cancelled(); ++c) {
    const auto level = static_cast<int>(cells_[c].upper >> kLevelShift);
    if (levels_.empty() || levels_.back().number != level) {
      levels_.push_back({level, {}});
    }
    levels_.back().box.extend(cells_[c].box);
  }
  if (!job.cancelled()) {
    lay_slots(job);
  }
  if (job.cancelled()) {
    cells_.clear();
  }
}

void FaceCells::lay_slots(const JobContext& job) {
  // Which of two cells gets the slot that both ask for depends on who comes first; what is found does not.
  slots_.assign(std::bit_ceil(2 * cells_.size() + 16), kNone);
  parallel_chunks(cells_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end && !job.cancelled(); ++c) {
      std::size_t slot = first_slot_of(cells_[c].key());
      std::uint32_t none = kNone;
      while (!std::atomic_ref(slots_[slot])
                  .compare_exchange_strong(none, static_cast<std::uint32_t>(c), std::memory_order_relaxed)) {
        none = kNone;
        slot = (slot + 1) & (slots_.size() - 1);
      }
    }
  });
}

std::size_t FaceCells::find_cells_beside(const Cell& own, std::vector<std::uint32_t>& beside) const {
  constexpr double kHalf = 0.5 * (1 + 1e-6);  // and what a box's size and middle are rounded by
  beside.clear();
  std::size_t looked_for = 0;
  const auto own_level = static_cast<int>(own.upper >> kLevelShift);
  for (const Level& level : levels_) {
    if (level.number < own_level || !own.box.intersects(level.box)) {
      continue;
    }
    const Vector3d reach = Vector3d::Constant(kHalf * cell_mm_[static_cast<std::size_t>(level.number)]);
    const Place from = place_of(own.box.min().cast<double>() - reach, level.number);
    const Place to = place_of(own.box.max().cast<double>() + reach, level.number);
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const Key key = key_of(level.number, {x, y, z});
          if (key < own.key()) {
            continue;  // its faces have met these already
          }
          ++looked_for;
          const std::uint32_t cell = slots_[slot_of(key)];
          if (cell != kNone && own.box.intersects(cells_[cell].box) &&
              (own.part == 0 || cells_[cell].part != own.part)) {
            beside.push_back(cell);
          }
        }
      }
    }
  }
  return looked_for;
}

int FaceCells::level_of(const Eigen::AlignedBox3f& box) const {
  const double cells = sizes_of(box).maxCoeff() / cell_mm_[0];
  if (!(cells > 1)) {
    return 0;
  }
  int power = 0;
  const double digits = std::frexp(cells, &power);  // in [0.5, 1)
  return digits > 0.5 ? power : power - 1;
}

FaceCells::Place FaceCells::place_of(const Vector3d& p, int level) const {
  const double cell = cell_mm_[static_cast<std::size_t>(level)];
  return {number_along_axis(p[0] / cell), number_along_axis(p[1] / cell), number_along_axis(p[2] / cell)};
}

FaceCells::Key FaceCells::key_of(int level, const Place& place) {
  constexpr unsigned kLowerOfY = 32 - kAxisBits;  // bits of y below the upper word
  constexpr std::int64_t kZero = std::int64_t{1} << (kAxisBits - 1);
  const auto x = static_cast<std::uint64_t>(place[0] + kZero);
  const auto y = static_cast<std::uint64_t>(place[1] + kZero);
  const auto z = static_cast<std::uint64_t>(place[2] + kZero);
  return {static_cast<std::uint64_t>(level) << kLevelShift | z << (kAxisBits - kLowerOfY) | y >> kLowerOfY,
          static_cast<std::uint32_t>(y << kAxisBits | x)};
}

std::size_t FaceCells::first_slot_of(const Key& key) const {
  std::uint64_t mixed = (key.upper + key.lower * 0xbf58476d1ce4e5b9ULL) * 0x9e3779b97f4a7c15ULL;
  mixed ^= mixed >> 32U;
  return mixed & (slots_.size() - 1);
}

std::size_t FaceCells::slot_of(const Key& key) const {
  std::size_t slot = first_slot_of(key);
  while (slots_[slot] != kNone && cells_[slots_[slot]].key() != key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

}  // namespace dubsar
