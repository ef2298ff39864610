// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/job.h"
#include "triangulation/count_work.h"

namespace dubsar {

/// Faces by the cell that their middle lies in, at the level whose cells are no smaller than their box: what
/// a box may touch lies in the cells within half a cell of it. There is a level for every size and a cell for
/// every place that floats can tell, so that neither a few huge or tiny faces nor parts far from each other
/// put many into one cell. Faces of one part (other than 0) are not asked about each other. At most 108 bytes
/// for each face. Of a job that is cancelled there are none.
class FaceCells {
 public:
  /// `which` of all faces, sound ones; smallest_mm: of the cells of the first level, at least the least float
  /// above 0 that has all its digits; those of the next are twice as large, and so on.
  FaceCells(std::span<const Eigen::Vector3f> positions, std::span<const std::array<std::uint32_t, 3>> faces,
            const std::vector<std::uint32_t>& which, std::span<const std::uint32_t> part_of_face,
            double smallest_mm, const JobContext& job);

  /// Cells that hold a face.
  [[nodiscard]] std::size_t size() const { return cells_.size(); }

  /// visit(face, other face) for the faces of a cell and those of other parts whose boxes touch theirs; over
  /// all cells each pair once, those of one face one after the other. `beside` is room to work in.
  template <class Visit>
  void for_each_touching(std::size_t at, std::vector<std::uint32_t>& beside, const JobContext& job,
                         const CountWork& counted, const Visit& visit) const {
    const Cell& own = cells_[at];
    count_work(counted, find_cells_beside(own, beside));
    for (std::uint32_t k = own.first; k < own.end && !job.cancelled(); ++k) {
      const Eigen::AlignedBox3f& box = boxes_[k];
      const std::uint32_t part = this->part(k);
      std::size_t compared = beside.size();
      for (const std::uint32_t other : beside) {
        const Cell& cell = cells_[other];
        if ((part != 0 && cell.part == part) || !box.intersects(cell.box)) {
          continue;
        }
        const std::uint32_t first = other == at ? k + 1 : cell.first;
        compared += cell.end - first;
        for (std::uint32_t m = first; m < cell.end; ++m) {
          if (box.intersects(boxes_[m]) && (part == 0 || parts_[m] != part)) {
            visit(entries_[k].face, entries_[m].face);
          }
        }
      }
      count_work(counted, compared);
    }
  }

 private:
  static constexpr int kLevels = 256;
  /// Level and place of a cell, 96 bits of both in the order in which cells are held.
  struct Key {
    std::uint64_t upper = 0;
    std::uint32_t lower = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Entry {
    std::uint64_t upper = 0;
    std::uint32_t lower = 0;
    std::uint32_t face = 0;
    auto operator<=>(const Entry&) const = default;
    [[nodiscard]] Key key() const { return {upper, lower}; }
  };
  struct Cell {
    std::uint64_t upper = 0;
    std::uint32_t lower = 0;
    std::uint32_t first = 0;  ///< of its entries
    std::uint32_t end = 0;
    std::uint32_t part = 0;   ///< of all of them, or 0
    Eigen::AlignedBox3f box;  ///< of them all
    [[nodiscard]] Key key() const { return {upper, lower}; }
  };
  struct Level {
    int number = 0;
    Eigen::AlignedBox3f box;  ///< of all in it
  };
  using Place = std::array<std::int64_t, 3>;

  void lay_cells(const JobContext& job);
  void lay_slots(const JobContext& job);
  /// The cells, this one and those behind it, in which something may touch what it holds; returns how many
  /// were looked for.
  std::size_t find_cells_beside(const Cell& own, std::vector<std::uint32_t>& beside) const;
  [[nodiscard]] int level_of(const Eigen::AlignedBox3f& box) const;
  [[nodiscard]] Place place_of(const Eigen::Vector3d& p, int level) const;
  [[nodiscard]] static Key key_of(int level, const Place& place);
  [[nodiscard]] std::size_t first_slot_of(const Key& key) const;
  [[nodiscard]] std::size_t slot_of(const Key& key) const;
  [[nodiscard]] std::uint32_t part(std::size_t at) const { return parts_.empty() ? 0 : parts_[at]; }

  std::array<double, kLevels> cell_mm_{};
  std::vector<Entry> entries_;
  std::vector<Eigen::AlignedBox3f> boxes_;  ///< by entry
  std::vector<std::uint32_t> parts_;        ///< by entry; empty: none are known
  std::vector<Cell> cells_;                 ///< by key
  std::vector<std::uint32_t> slots_;        ///< of cells_, by hash; a power of two
  std::vector<Level> levels_;               ///< that hold a cell, in order
};

}  // namespace dubsar
