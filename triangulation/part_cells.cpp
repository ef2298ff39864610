// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/part_cells.h"

#include <algorithm>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;
using Positions = std::span<const Vector3f>;
using Face = std::array<std::uint32_t, 3>;

/// What part lies in each cell of a coarse raster, by hashing.
class PartCells {
 public:
  static constexpr std::uint32_t kMixed = 0;

  PartCells(const Vector3f& low, float cell_mm) : low_(low), per_mm_(1.0F / cell_mm), slots_(1U << 12U) {}

  [[nodiscard]] std::uint64_t key_of(const Vector3f& p) const {
    const auto at = [&](int k) {
      return static_cast<std::uint64_t>(std::clamp((p[k] - low_[k]) * per_mm_ + 1.0F, 1.0F, kMostCell));
    };
    return at(2) << (2 * kAxisBits) | at(1) << kAxisBits | at(0);
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

std::vector<std::uint32_t> faces_at_stake(Positions positions, std::span<const Face> faces,
                                          std::span<const std::uint32_t> part_of_face,
                                          const Eigen::AlignedBox3f& all, float cell_mm) {
  PartCells cells(all.min(), cell_mm);
  std::vector<std::uint64_t> keys(faces.size());
  parallel_for_each_index(
      faces.size(), [&](std::size_t i) { keys[i] = cells.key_of(box_of(positions, faces[i]).center()); },
      4096);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1] || part_of_face[i] != part_of_face[i - 1]) {
      cells.add(keys[i], part_of_face[i]);
    }
    const Eigen::AlignedBox3f box = box_of(positions, faces[i]);
    if (box.sizes().maxCoeff() > cell_mm) {
      // It may meet faces of cells that do not touch that of its middle.
      const Vector3f high = box.max() + Vector3f::Constant(cell_mm);
      for (float z = box.min().z() - cell_mm; z < high.z() + cell_mm; z += cell_mm) {
        for (float y = box.min().y() - cell_mm; y < high.y() + cell_mm; y += cell_mm) {
          for (float x = box.min().x() - cell_mm; x < high.x() + cell_mm; x += cell_mm) {
            cells.add(cells.key_of({x, y, z}), PartCells::kMixed);
          }
        }
      }
    }
  }
  std::vector<std::uint8_t> calm(cells.slot_count(), 0);
  parallel_for_each_index(
      calm.size(),
      [&](std::size_t slot) {
        calm[slot] = cells.is_used(slot) && cells.is_calm(cells.key_in(slot)) ? 1 : 0;
      },
      4096);
  std::vector<std::uint32_t> out;
  std::size_t slot = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) {
      slot = cells.slot_of(keys[i]);
    }
    if (calm[slot] == 0) {
      out.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return out;
}

}  // namespace dubsar
