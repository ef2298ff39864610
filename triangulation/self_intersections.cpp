// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>

#include "core/huge_pages.h"
#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "triangulation/crowded_vertices.h"
#include "triangulation/face_cut.h"
#include "triangulation/part_cells.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;
using Positions = std::span<const Vector3f>;
constexpr std::uint32_t kNoFace = 0xffffffffU;
using Face = std::array<std::uint32_t, 3>;

/// Faces by the cell that their middle lies in, at the level whose cells are no smaller than their box: what
/// a box may touch lies in the cells within half a cell of it. Faces of one part are not asked about each
/// other.
class FaceCells {
 public:
  FaceCells(Positions positions, std::span<const Face> all_faces, const std::vector<std::uint32_t>& faces,
            std::span<const std::uint32_t> part_of_face, const Vector3f& low, float smallest_mm)
      : low_(low), smallest_mm_(smallest_mm) {
    for (int level = 0; level <= kMostLevel; ++level) {
      cell_mm_[static_cast<std::size_t>(level)] = std::ldexp(smallest_mm, level);
    }
    resize_in_huge_pages(entries_, faces.size());
    parallel_for_each_index(
        faces.size(),
        [&](std::size_t k) {
          const Eigen::AlignedBox3f box = box_of(positions, all_faces[faces[k]]);
          const int level = level_of(box);
          entries_[k] = {key_of(level, cell_of(box.center(), level)), faces[k]};
        },
        4096);
    parallel_sort(entries_.begin(), entries_.end(), std::less<>{});
    resize_in_huge_pages(boxes_, entries_.size());
    parts_.resize(part_of_face.empty() ? 0 : entries_.size());
    parallel_for_each_index(
        entries_.size(),
        [&](std::size_t k) {
          const std::uint32_t face = entries_[k].second;
          boxes_[k] = box_of(positions, all_faces[face]);
          if (!parts_.empty()) {
            parts_[k] = part_of_face[face];
          }
        },
        4096);
    lay_cells();
  }

  [[nodiscard]] int level_of(const Eigen::AlignedBox3f& box) const {
    int level = 0;
    for (float cell = smallest_mm_; cell < box.sizes().maxCoeff() && level < kMostLevel; cell *= 2) {
      ++level;
    }
    return level;
  }

  /// Cells that hold a face.
  [[nodiscard]] std::size_t size() const { return cells_.size(); }

  /// visit(face, other face) for the faces of a cell and those of other parts whose boxes touch theirs; over
  /// all cells each pair once, those of one face one after the other. `beside` is room to work in.
  template <class Visit>
  void for_each_touching(std::size_t at, std::vector<std::uint32_t>& beside, const JobContext& job,
                         const Visit& visit) const {
    const Cell& own = cells_[at];
    find_cells_beside(own, beside);
    for (std::uint32_t k = own.first; k < own.end && !job.cancelled(); ++k) {
      const Eigen::AlignedBox3f& box = boxes_[k];
      const std::uint32_t part = this->part(k);
      for (const std::uint32_t other : beside) {
        const Cell& cell = cells_[other];
        if ((part != 0 && cell.part == part) || !box.intersects(cell.box)) {
          continue;
        }
        for (std::uint32_t m = other == at ? k + 1 : cell.first; m < cell.end; ++m) {
          if (box.intersects(boxes_[m]) && (part == 0 || parts_[m] != part)) {
            visit(entries_[k].second, entries_[m].second);
          }
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  static constexpr unsigned kAxisBits = 19;
  static constexpr unsigned kLevelShift = 3 * kAxisBits;
  static constexpr int kMostLevel = 40;
  /// From it on, and at the last level, all is one cell: no number of one gets infinite.
  static constexpr float kMostCell_mm = 1e30F;
  static constexpr std::int64_t kMostCell = (std::int64_t{1} << kAxisBits) - 1;
  using Place = std::array<std::int64_t, 3>;
  struct Cell {
    std::uint64_t key = 0;
    std::uint32_t first = 0;  ///< of its entries
    std::uint32_t end = 0;
    std::uint32_t part = 0;   ///< of all of them, or 0
    Eigen::AlignedBox3f box;  ///< of them all
  };

  void lay_cells() {
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      if (k == 0 || entries_[k].first != entries_[k - 1].first) {
        cells_.push_back({entries_[k].first, static_cast<std::uint32_t>(k), 0, 0, {}});
        levels_ |= 1ULL << (entries_[k].first >> kLevelShift);
      }
    }
    parallel_for_each_index(
        cells_.size(),
        [&](std::size_t c) {
          Cell& cell = cells_[c];
          cell.end =
              c + 1 < cells_.size() ? cells_[c + 1].first : static_cast<std::uint32_t>(entries_.size());
          cell.part = part(cell.first);
          for (std::uint32_t k = cell.first; k < cell.end; ++k) {
            cell.part = part(k) == cell.part ? cell.part : 0;
            cell.box.extend(boxes_[k]);
          }
        },
        4096);
    // Which of two cells gets the slot that both ask for depends on who comes first; what is found does not.
    slots_.assign(std::bit_ceil(2 * cells_.size() + 16), kNone);
    parallel_for_each_index(
        cells_.size(),
        [&](std::size_t c) {
          std::size_t slot = first_slot_of(cells_[c].key);
          std::uint32_t none = kNone;
          while (
              !std::atomic_ref(slots_[slot])
                   .compare_exchange_strong(none, static_cast<std::uint32_t>(c), std::memory_order_relaxed)) {
            none = kNone;
            slot = (slot + 1) & (slots_.size() - 1);
          }
        },
        4096);
  }

  /// The cells, this one and those behind it, in which something may touch what it holds.
  void find_cells_beside(const Cell& own, std::vector<std::uint32_t>& beside) const {
    beside.clear();
    for (auto level = static_cast<int>(own.key >> kLevelShift); level <= kMostLevel; ++level) {
      if ((levels_ >> static_cast<unsigned>(level) & 1ULL) == 0) {
        continue;
      }
      const float half = 0.5F * cell_mm_[static_cast<std::size_t>(level)];
      const auto from = cell_of(own.box.min() - Vector3f::Constant(half), level);
      const auto to = cell_of(own.box.max() + Vector3f::Constant(half), level);
      for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        for (std::int64_t y = from[1]; y <= to[1]; ++y) {
          for (std::int64_t x = from[0]; x <= to[0]; ++x) {
            const std::uint64_t key = key_of(level, {x, y, z});
            if (key < own.key) {
              continue;  // its faces have met these already
            }
            const std::uint32_t cell = slots_[slot_of(key)];
            if (cell != kNone && own.box.intersects(cells_[cell].box) &&
                (own.part == 0 || cells_[cell].part != own.part)) {
              beside.push_back(cell);
            }
          }
        }
      }
    }
  }

  [[nodiscard]] Place cell_of(const Vector3f& p, int level) const {
    const float cell = cell_mm_[static_cast<std::size_t>(level)];
    Place out{};
    for (int k = 0; k < 3 && level < kMostLevel && cell < kMostCell_mm; ++k) {
      const float at = std::clamp((p[k] - low_[k]) / cell, 0.0F, static_cast<float>(kMostCell - 1));
      out[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(at);
    }
    return out;
  }
  [[nodiscard]] static std::uint64_t key_of(int level, const Place& cell) {
    return static_cast<std::uint64_t>(level) << kLevelShift |
           static_cast<std::uint64_t>(cell[2]) << (2 * kAxisBits) |
           static_cast<std::uint64_t>(cell[1]) << kAxisBits | static_cast<std::uint64_t>(cell[0]);
  }
  [[nodiscard]] std::size_t first_slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    mixed ^= mixed >> 32U;
    return mixed & (slots_.size() - 1);
  }
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::size_t slot = first_slot_of(key);
    while (slots_[slot] != kNone && cells_[slots_[slot]].key != key) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

  [[nodiscard]] std::uint32_t part(std::size_t at) const { return parts_.empty() ? 0 : parts_[at]; }

  Vector3f low_;
  float smallest_mm_;
  std::array<float, kMostLevel + 1> cell_mm_{};
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
  std::vector<Eigen::AlignedBox3f> boxes_;  ///< by entry
  std::vector<std::uint32_t> parts_;        ///< by entry; empty: none are known
  std::vector<Cell> cells_;                 ///< by key
  std::vector<std::uint32_t> slots_;        ///< of cells_, by hash; a power of two
  std::uint64_t levels_ = 0;
};

/// Without area and without an inside: nothing cuts it.
bool is_point(const Face& f) {
  return f[0] == f[1] && f[1] == f[2];
}

bool is_sound(Positions positions, const Face& f) {
  return std::all_of(f.begin(), f.end(),
                     [&](std::uint32_t v) { return v < positions.size() && positions[v].allFinite(); });
}

/// How many faces are how large: of the sizes above 0, by their power of two.
class Sizes {
 public:
  void add(float size_mm) { ++count_[std::bit_cast<std::uint32_t>(size_mm) >> kMantissaBits]; }
  void add(const Sizes& other) {
    for (std::size_t k = 0; k < count_.size(); ++k) {
      count_[k] += other.count_[k];
    }
  }
  /// A size that so many faces, or a few more, are below: up to twice the one that they are just below.
  [[nodiscard]] double above(std::size_t faces) const {
    std::size_t below = 0;
    std::size_t power = 1;  // the first holds those too small for their power
    while (power + 1 < count_.size() && (below += count_[power]) <= faces) {
      ++power;
    }
    return std::ldexp(1.0, static_cast<int>(power) - 126);
  }

 private:
  static constexpr unsigned kMantissaBits = 23;
  std::array<std::uint32_t, 256> count_{};
};

/// What cells are to be made for: the mean size of the faces, unless a few that are huge make that far more
/// than most are. Then a size that hardly any are below, as larger ones have coarser cells.
double size_to_sort_by(const Sizes& sizes, std::size_t count, double mean_mm) {
  constexpr double kFarAboveHalf = 4.0;
  constexpr double kFarAboveLeast = 16.0;
  constexpr std::size_t kHardlyAny = 256;   // one of so many
  constexpr std::size_t kMostOfOne = 4096;  // and no more, as they may all lie in one cell
  const double least_mm = sizes.above(std::min(count / kHardlyAny, kMostOfOne));
  return mean_mm > kFarAboveHalf * sizes.above(count / 2) || mean_mm > kFarAboveLeast * least_mm
             ? std::min(least_mm, mean_mm)
             : mean_mm;
}

/// About where most of the faces are: halfway along each axis, of a thousand of them.
Vector3f middle_of(Positions positions, std::span<const Face> all_faces,
                   std::span<const std::uint32_t> faces) {
  const std::size_t step = faces.size() / 1000 + 1;
  Vector3f middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> at;
    for (std::size_t k = 0; k < faces.size(); k += step) {
      at.push_back(positions[all_faces[faces[k]][0]][axis]);
    }
    const auto half = at.begin() + static_cast<std::ptrdiff_t>(at.size() / 2);
    std::nth_element(at.begin(), half, at.end());
    middle[axis] = *half;
  }
  return middle;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> self_intersections(
    std::span<const Vector3f> positions, std::span<const Face> all_faces,
    std::span<const std::uint32_t> part_of_face, const JobContext& job) {
  struct Extent {
    Eigen::AlignedBox3f box;
    double sizes = 0;
    float largest = 0;
    Sizes by_power;
    std::size_t count = 0;
    std::size_t unsound = 0;
  };
  const Extent extent = parallel_reduce_ordered(
      all_faces.size(), 65536, Extent{},
      [&](std::size_t begin, std::size_t end) {
        Extent part;
        for (std::size_t i = begin; i < end; ++i) {
          if (is_point(all_faces[i])) {
            continue;
          }
          if (!is_sound(positions, all_faces[i])) {
            ++part.unsound;
          } else {
            const Eigen::AlignedBox3f box = box_of(positions, all_faces[i]);
            const float size = box.sizes().maxCoeff();
            part.box.extend(box);
            part.sizes += static_cast<double>(size);
            part.largest = std::max(part.largest, size);
            part.by_power.add(size);
            ++part.count;
          }
        }
        return part;
      },
      [](Extent& total, const Extent& part) {
        total.box.extend(part.box);
        total.sizes += part.sizes;
        total.largest = std::max(total.largest, part.largest);
        total.by_power.add(part.by_power);
        total.count += part.count;
        total.unsound += part.unsound;
      });
  if (extent.count < 2 || !(extent.sizes > 0)) {
    return {};
  }
  constexpr double kCellOfMean = 3.0;
  constexpr double kMostOfMean = 100.0;  // one huge face would fill all cells
  std::vector<std::uint32_t> faces;
  const double mean_mm = extent.sizes / static_cast<double>(extent.count);
  if (!part_of_face.empty() && extent.unsound == 0 &&
      static_cast<double>(extent.largest) < kMostOfMean * mean_mm) {
    faces = faces_at_stake(positions, all_faces, part_of_face, extent.box,
                           static_cast<float>(kCellOfMean * mean_mm));
    std::erase_if(faces, [&](std::uint32_t f) { return is_point(all_faces[f]); });
  } else {
    for (std::uint32_t i = 0; i < all_faces.size(); ++i) {
      if (!is_point(all_faces[i]) && is_sound(positions, all_faces[i])) {
        faces.push_back(i);
      }
    }
  }
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pairs out =
      part_of_face.empty() ? take_cuts_at_crowded_vertices(positions, all_faces, faces, job) : Pairs{};
  // Beyond what the numbers of the finest cells reach, all is in the last of them: that is to be few faces.
  constexpr float kMostCells = 400000.0F;
  constexpr double kCellOfSize = 2.5;
  const auto smallest_mm = static_cast<float>(
      std::min(kCellOfSize * size_to_sort_by(extent.by_power, extent.count, mean_mm), 1e29));
  Vector3f low = extent.box.min();
  if (extent.box.sizes().maxCoeff() > kMostCells * smallest_mm && !faces.empty()) {
    low = low.cwiseMax(middle_of(positions, all_faces, faces) -
                       Vector3f::Constant(0.5F * kMostCells * smallest_mm));
  }
  const FaceCells cells(positions, all_faces, faces, part_of_face, low, smallest_mm);
  const Pairs elsewhere = parallel_reduce_ordered(
      cells.size(), 256, Pairs{},
      [&](std::size_t begin, std::size_t end) {
        Pairs found;
        std::vector<std::uint32_t> beside;
        std::uint32_t of_plane = kNoFace;
        FacePlane plane;
        for (std::size_t cell = begin; cell < end && !job.cancelled(); ++cell) {
          cells.for_each_touching(cell, beside, job, [&](std::uint32_t a, std::uint32_t b) {
            if (a != of_plane) {
              plane = FacePlane(positions, all_faces[a]);
              of_plane = a;
            }
            if (faces_cut(positions, all_faces[a], plane, all_faces[b])) {
              found.push_back(std::minmax(a, b));
            }
          });
        }
        return found;
      },
      [](Pairs& total, const Pairs& part) { total.insert(total.end(), part.begin(), part.end()); });
  out.insert(out.end(), elsewhere.begin(), elsewhere.end());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace dubsar
