// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/part_cells.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;
using Positions = std::span<const Vector3f>;
using Face = std::array<std::uint32_t, 3>;
constexpr std::size_t kGrain = 16384;

/// What part lies in each cell of a coarse raster, by hashing.
class PartCells {
 public:
  static constexpr std::uint32_t kMixed = 0;
  using Entry = std::pair<std::uint64_t, std::uint32_t>;  ///< key of a cell, part

  PartCells(const Vector3f& low, float cell_mm) : low_(low), per_mm_(1.0F / cell_mm), slots_(1U << 12U) {}

  [[nodiscard]] std::uint64_t key_of(const Vector3f& p) const {
    return key_of(cell(p, 0), cell(p, 1), cell(p, 2));
  }
  /// visit(key) for all cells that a box touches.
  template <class Visit>
  void for_each_key(const Eigen::AlignedBox3f& box, const Visit& visit) const {
    for (std::uint64_t z = cell(box.min(), 2); z <= cell(box.max(), 2); ++z) {
      for (std::uint64_t y = cell(box.min(), 1); y <= cell(box.max(), 1); ++y) {
        for (std::uint64_t x = cell(box.min(), 0); x <= cell(box.max(), 0); ++x) {
          visit(key_of(x, y, z));
        }
      }
    }
  }
  void add(std::uint64_t key, std::uint32_t part) {
    if (2 * (count_ + 1) > slots_.size()) {
      grow();
    }
    Slot& slot = slots_[slot_of(key)];
    if (slot.key == kEmpty) {
      slot = {key, part};
      ++count_;
    } else if (slot.part != part) {
      slot.part = kMixed;
    }
  }
  /// For another raster of the same cells.
  [[nodiscard]] std::vector<Entry> entries() const {
    std::vector<Entry> out;
    out.reserve(count_);
    for (const Slot& slot : slots_) {
      if (slot.key != kEmpty) {
        out.emplace_back(slot.key, slot.part);
      }
    }
    return out;
  }
  /// True when nothing but one part lies in the cell and in those around it.
  [[nodiscard]] bool is_calm(std::uint64_t key) const {
    const std::uint32_t part = slots_[slot_of(key)].part;
    if (part == kMixed) {
      return false;
    }
    for (const std::uint64_t dz : {kMinusOne, kZero, kOne}) {
      for (const std::uint64_t dy : {kMinusOne, kZero, kOne}) {
        for (const std::uint64_t dx : {kMinusOne, kZero, kOne}) {
          const Slot& slot = slots_[slot_of(key + (dz << (2 * kAxisBits)) + (dy << kAxisBits) + dx)];
          if (slot.key != kEmpty && slot.part != part) {
            return false;
          }
        }
      }
    }
    return true;
  }
  /// Cells by slot, for a table of answers.
  [[nodiscard]] std::size_t slot_count() const { return slots_.size(); }
  [[nodiscard]] bool is_used(std::size_t slot) const { return slots_[slot].key != kEmpty; }
  [[nodiscard]] std::uint64_t key_in(std::size_t slot) const { return slots_[slot].key; }
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    mixed ^= mixed >> 32U;
    std::size_t slot = mixed & (slots_.size() - 1);
    while (slots_[slot].key != kEmpty && slots_[slot].key != key) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

 private:
  [[nodiscard]] std::uint64_t cell(const Vector3f& p, int axis) const {
    return static_cast<std::uint64_t>(std::clamp((p[axis] - low_[axis]) * per_mm_ + 1.0F, 1.0F, kMostCell));
  }
  [[nodiscard]] static std::uint64_t key_of(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return z << (2 * kAxisBits) | y << kAxisBits | x;
  }

  static constexpr unsigned kAxisBits = 21;
  static constexpr float kMostCell = 2.0e6F;
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  static constexpr std::uint64_t kMinusOne = ~std::uint64_t{0};
  static constexpr std::uint64_t kZero = 0;
  static constexpr std::uint64_t kOne = 1;
  struct Slot {
    std::uint64_t key = kEmpty;
    std::uint32_t part = kMixed;
  };
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != kEmpty) {
        slots_[slot_of(slot.key)] = slot;
      }
    }
  }

  Vector3f low_;
  float per_mm_;
  std::vector<Slot> slots_;  ///< a power of two
  std::size_t count_ = 0;
};

}  // namespace

namespace {

/// Calls visit(key) for the cells that a face may lie in: that of its middle, or all that its box touches
/// where it is larger than a cell.
template <class Visit>
void for_each_cell(const PartCells& cells, const Eigen::AlignedBox3f& box, float cell_mm,
                   const Visit& visit) {
  if (box.sizes().maxCoeff() <= cell_mm) {
    visit(cells.key_of(box.center()));
  } else {
    cells.for_each_key(box, visit);
  }
}

}  // namespace

std::vector<std::uint32_t> faces_at_stake(Positions positions, std::span<const Face> faces,
                                          std::span<const std::uint32_t> part_of_face,
                                          const Eigen::AlignedBox3f& all, float cell_mm,
                                          const JobContext& job) {
  PartCells cells(all.min(), cell_mm);
  using Entries = std::vector<PartCells::Entry>;
  // Some thousand faces beside each other lie in few cells: these are gathered side by side, and what is left
  // for one thread is to put them together.
  const Entries entries = parallel_reduce_ordered(
      faces.size(), kGrain, Entries{},
      [&](std::size_t begin, std::size_t end) {
        PartCells found(all.min(), cell_mm);
        PartCells::Entry last;  // of no cell
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          for_each_cell(found, box_of(positions, faces[i]), cell_mm, [&](std::uint64_t key) {
            const PartCells::Entry entry(key, part_of_face[i]);
            if (entry != last) {  // faces beside each other mostly share theirs
              found.add(key, part_of_face[i]);
              last = entry;
            }
          });
        }
        return found.entries();
      },
      [](Entries& total, const Entries& part) { total.insert(total.end(), part.begin(), part.end()); });
  for (std::size_t k = 0; k < entries.size() && !job.cancelled(); ++k) {
    cells.add(entries[k].first, entries[k].second);
  }
  if (job.cancelled()) {
    return {};
  }
  std::vector<std::uint8_t> calm(cells.slot_count(), 0);
  parallel_for_each_index(
      calm.size(),
      [&](std::size_t slot) {
        calm[slot] = cells.is_used(slot) && cells.is_calm(cells.key_in(slot)) ? 1 : 0;
      },
      4096);
  using Faces = std::vector<std::uint32_t>;
  return parallel_reduce_ordered(
      faces.size(), kGrain, Faces{},
      [&](std::size_t begin, std::size_t end) {
        Faces found;
        std::uint64_t last_key = 0;  // of no cell
        bool last_calm = false;
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          bool at_stake = false;
          for_each_cell(cells, box_of(positions, faces[i]), cell_mm, [&](std::uint64_t key) {
            last_calm = key == last_key ? last_calm : calm[cells.slot_of(key)] != 0;
            last_key = key;
            at_stake = at_stake || !last_calm;
          });
          if (at_stake) {
            found.push_back(static_cast<std::uint32_t>(i));
          }
        }
        return found;
      },
      [](Faces& total, const Faces& part) { total.insert(total.end(), part.begin(), part.end()); });
}

}  // namespace dubsar
