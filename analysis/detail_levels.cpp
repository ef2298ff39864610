// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/detail_levels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Face = std::array<std::uint32_t, 3>;
using Cell = Eigen::Array3i;

constexpr std::size_t kAtOnce = std::size_t{1} << 16U;
constexpr int kMostCells = 1 << 20;  ///< along a side; more do not fit into a key

/// Which vertex stands for the others of its cell: the one of the lowest number, whoever comes first.
class CellTable {
 public:
  explicit CellTable(std::size_t least) : slots_(std::bit_ceil(std::max<std::size_t>(1024, least))) {
    places_ = std::make_unique<Place[]>(slots_);
  }

  /// The slot of a cell; nothing when the table has become too full to go on with.
  std::optional<std::uint32_t> add(const Cell& cell, std::uint32_t vertex) {
    const std::uint64_t key = key_of(cell);
    const std::size_t first = slot_of(cell);
    for (std::size_t k = 0; k < kMostProbes; ++k) {
      const std::size_t slot = (first + k) & (slots_ - 1);
      Place& place = places_[slot];
      std::uint64_t there = place.key.load(std::memory_order_relaxed);
      if (there == kFree) {
        place.key.compare_exchange_strong(there, key, std::memory_order_relaxed);
        there = there == kFree ? key : there;
      }
      if (there == key) {
        std::uint32_t lowest = place.vertex.load(std::memory_order_relaxed);
        while (vertex < lowest &&
               !place.vertex.compare_exchange_weak(lowest, vertex, std::memory_order_relaxed)) {
        }
        return static_cast<std::uint32_t>(slot);
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] std::uint32_t vertex_in(std::uint32_t slot) const {
    return places_[slot].vertex.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::size_t slots() const { return slots_; }

 private:
  static constexpr std::uint64_t kFree = 0;
  static constexpr std::size_t kMostProbes = 512;
  struct Place {
    std::atomic<std::uint64_t> key = kFree;
    std::atomic<std::uint32_t> vertex = std::numeric_limits<std::uint32_t>::max();
  };
  static std::uint64_t key_of(const Cell& cell) {
    return (static_cast<std::uint64_t>(cell.x()) << 42U | static_cast<std::uint64_t>(cell.y()) << 21U |
            static_cast<std::uint64_t>(cell.z())) +
           1;
  }
  /// Cells of a cube of 4 lie together: who looks one up has most of its neighbours at hand.
  [[nodiscard]] std::size_t slot_of(const Cell& cell) const {
    std::uint64_t cube = key_of(cell / 4) * 0x9e3779b97f4a7c15ULL;
    cube = (cube ^ (cube >> 32U)) * 0xbf58476d1ce4e5b9ULL;
    const auto within =
        static_cast<std::uint64_t>((cell.x() & 3) << 4 | (cell.y() & 3) << 2 | (cell.z() & 3));
    return static_cast<std::size_t>((cube >> 32U << 6U) | within) & (slots_ - 1);
  }

  std::size_t slots_;
  std::unique_ptr<Place[]> places_;
};

/// Sets, for each of `of`, the one of them that stands for it; false where no table can hold the cells.
/// `cells_guess` only says how large the table is at first.
bool set_stand_ins(std::span<const Eigen::Vector3f> positions, const Eigen::Vector3f& low, float cell_mm,
                   std::size_t cells_guess, std::span<const std::uint32_t> of,
                   std::vector<std::uint32_t>& stands_for) {
  for (std::size_t slots = 4 * cells_guess; slots < 64 * of.size() + 4 * cells_guess + 1; slots *= 4) {
    CellTable table(slots);
    std::atomic<bool> full = false;
    parallel_chunks(of.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end && !full; ++k) {
        const std::uint32_t v = of[k];
        const Eigen::Array3f at = (positions[v] - low).array() / cell_mm;
        const Cell cell = at.max(0.0F).min(static_cast<float>(kMostCells)).cast<int>();
        if (const auto mine = table.add(cell, v)) {
          stands_for[v] = *mine;
        } else {
          full = true;
        }
      }
    });
    if (!full) {
      parallel_for_each_index(
          of.size(), [&](std::size_t k) { stands_for[of[k]] = table.vertex_in(stands_for[of[k]]); }, kAtOnce);
      return true;
    }
  }
  return false;
}

/// The faces that keep three corners, in their order.
DetailLevel thinned(std::span<const Face> faces, std::span<const std::uint32_t> from,
                    std::span<const std::uint32_t> stands_for) {
  const std::size_t chunks = (faces.size() + kAtOnce - 1) / kAtOnce;
  std::vector<DetailLevel> parts(chunks);
  parallel_chunks(faces.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
    DetailLevel& part = parts[begin / kAtOnce];
    for (std::size_t f = begin; f < end; ++f) {
      const Face face{stands_for[faces[f][0]], stands_for[faces[f][1]], stands_for[faces[f][2]]};
      if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) {
        part.faces.push_back(face);
        part.from.push_back(from.empty() ? static_cast<std::uint32_t>(f) : from[f]);
      }
    }
  });
  DetailLevel out;
  std::size_t count = 0;
  for (const DetailLevel& part : parts) {
    count += part.faces.size();
  }
  out.faces.reserve(count);
  out.from.reserve(count);
  for (const DetailLevel& part : parts) {
    out.faces.insert(out.faces.end(), part.faces.begin(), part.faces.end());
    out.from.insert(out.from.end(), part.from.begin(), part.from.end());
  }
  return out;
}

/// Of some of the faces, for all of them.
double guessed_area_mm2(std::span<const Eigen::Vector3f> positions, std::span<const Face> faces) {
  const std::size_t stride = std::max<std::size_t>(1, faces.size() / 100000);
  double area = 0;
  std::size_t looked_at = 0;
  for (std::size_t f = 0; f < faces.size(); f += stride, ++looked_at) {
    const auto& [a, b, c] = faces[f];
    area +=
        0.5 * static_cast<double>((positions[b] - positions[a]).cross(positions[c] - positions[a]).norm());
  }
  return area * static_cast<double>(faces.size()) / static_cast<double>(std::max<std::size_t>(1, looked_at));
}

}  // namespace

std::vector<DetailLevel> detail_levels(std::span<const Eigen::Vector3f> positions_mm,
                                       std::span<const Face> faces, const Eigen::AlignedBox3f& box_mm,
                                       std::size_t fewest_faces) {
  fewest_faces = std::max<std::size_t>(1, fewest_faces);
  if (faces.size() <= fewest_faces * 3 / 2) {
    return {};
  }
  std::size_t count = 1;
  std::size_t most_faces = fewest_faces;
  for (; 4 * most_faces < faces.size() / 3; most_faces *= 4) {
    ++count;
  }
  // A cell that a plane crosses holds about 1.5 cell faces of it, and gives two faces.
  const double area = guessed_area_mm2(positions_mm, faces);
  float coarsest_mm = static_cast<float>(std::sqrt(3.0 * area / static_cast<double>(fewest_faces)));
  const float finer = static_cast<float>(1U << (count - 1));
  coarsest_mm = std::max(coarsest_mm, finer * box_mm.sizes().maxCoeff() / static_cast<float>(kMostCells));
  if (!(coarsest_mm > 0)) {
    return {};
  }
  std::vector<DetailLevel> levels(count);
  std::vector<std::uint32_t> stands_for(positions_mm.size());
  std::vector<std::uint32_t> left(positions_mm.size());  // vertices that the last level still has
  std::iota(left.begin(), left.end(), 0U);
  for (std::size_t k = count; k-- > 0; most_faces /= 4) {
    const float cell_mm = coarsest_mm / static_cast<float>(1U << k);
    // A vertex and all that it stood for lie in one cell of the coarser level too: it is enough to look at
    // it.
    if (!set_stand_ins(positions_mm, box_mm.min(), cell_mm, most_faces / 2, left, stands_for)) {
      return {};
    }
    std::erase_if(left, [&](std::uint32_t v) { return stands_for[v] != v; });
    levels[k] = k + 1 == count ? thinned(faces, {}, stands_for)
                               : thinned(levels[k + 1].faces, levels[k + 1].from, stands_for);
    levels[k].cell_mm = cell_mm;
  }
  return levels;
}

}  // namespace dubsar
