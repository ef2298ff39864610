// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Corners = std::array<Vector3d, 3>;

/// Six times the volume of the tetrahedron abcd.
double volume(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the segment pq passes through the inside of the triangle.
bool passes_through(const Vector3d& p, const Vector3d& q, const Corners& t) {
  const double at_p = volume(t[0], t[1], t[2], p);
  const double at_q = volume(t[0], t[1], t[2], q);
  if (!(at_p * at_q < 0)) {
    return false;
  }
  const double u = volume(p, q, t[0], t[1]);
  const double v = volume(p, q, t[1], t[2]);
  const double w = volume(p, q, t[2], t[0]);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

using Positions = std::span<const Vector3f>;
using Face = std::array<std::uint32_t, 3>;

Corners corners_of(Positions positions, const Face& f) {
  return {positions[f[0]].cast<double>(), positions[f[1]].cast<double>(), positions[f[2]].cast<double>()};
}

bool cut(Positions positions, const Face& fa, const Face& fb) {
  int shared = 0;
  for (const std::uint32_t v : fa) {
    shared += v == fb[0] || v == fb[1] || v == fb[2] ? 1 : 0;
  }
  if (shared > 1) {
    return false;
  }
  const Corners ca = corners_of(positions, fa);
  const Corners cb = corners_of(positions, fb);
  const auto edges_cut = [&](const Face& f, const Corners& c,
                             const Face& other, const Corners& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const bool at_shared = std::count(other.begin(), other.end(), f[k]) != 0 ||
                             std::count(other.begin(), other.end(), f[next]) != 0;
      if (!at_shared && passes_through(c[k], c[next], t)) {
        return true;
      }
    }
    return false;
  };
  return edges_cut(fa, ca, fb, cb) || edges_cut(fb, cb, fa, ca);
}

/// Faces by the cell that their middle lies in, at the level whose cells are no smaller than their box: what
/// a box may touch lies in the cells within half a cell of it.
class FaceCells {
 public:
  FaceCells(const std::vector<Eigen::AlignedBox3f>& boxes, const std::vector<std::uint32_t>& faces,
            const Vector3f& low, float smallest_mm)
      : low_(low), smallest_mm_(smallest_mm) {
    entries_.resize(faces.size());
    parallel_for_each_index(
        faces.size(),
        [&](std::size_t k) {
          const Eigen::AlignedBox3f& box = boxes[faces[k]];
          const int level = level_of(box);
          entries_[k] = {key_of(level, cell_of(box.center(), level)), faces[k]};
        },
        4096);
    std::sort(entries_.begin(), entries_.end());
    slots_.assign(std::bit_ceil(2 * entries_.size() + 16), kNone);
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      if (k == 0 || entries_[k].first != entries_[k - 1].first) {
        slots_[slot_of(entries_[k].first)] = static_cast<std::uint32_t>(k);
        levels_ |= 1ULL << (entries_[k].first >> kLevelShift);
      }
    }
  }

  [[nodiscard]] int level_of(const Eigen::AlignedBox3f& box) const {
    int level = 0;
    for (float cell = smallest_mm_; cell < box.sizes().maxCoeff() && level < kMostLevel; cell *= 2) {
      ++level;
    }
    return level;
  }

  /// visit(face) for those that a box could touch, at the box's own level and coarser ones.
  template <class Visit>
  void for_each_near(const Eigen::AlignedBox3f& box, const Visit& visit) const {
    for (int level = level_of(box); level <= kMostLevel; ++level) {
      if ((levels_ >> static_cast<unsigned>(level) & 1ULL) == 0) {
        continue;
      }
      const float half = 0.5F * std::ldexp(smallest_mm_, level);
      const auto from = cell_of(box.min() - Vector3f::Constant(half), level);
      const auto to = cell_of(box.max() + Vector3f::Constant(half), level);
      for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        for (std::int64_t y = from[1]; y <= to[1]; ++y) {
          for (std::int64_t x = from[0]; x <= to[0]; ++x) {
            const std::uint64_t key = key_of(level, {x, y, z});
            const std::uint32_t first = slots_[slot_of(key)];
            for (std::size_t k = first; first != kNone && k < entries_.size() && entries_[k].first == key; ++k) {
              visit(entries_[k].second);
            }
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
  static constexpr std::int64_t kMostCell = (std::int64_t{1} << kAxisBits) - 1;
  using Cell = std::array<std::int64_t, 3>;

  [[nodiscard]] Cell cell_of(const Vector3f& p, int level) const {
    const float cell = std::ldexp(smallest_mm_, level);
    Cell out{};
    for (int k = 0; k < 3; ++k) {
      const float at = std::clamp((p[k] - low_[k]) / cell, 0.0F, static_cast<float>(kMostCell - 1));
      out[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(at);
    }
    return out;
  }
  [[nodiscard]] static std::uint64_t key_of(int level, const Cell& cell) {
    return static_cast<std::uint64_t>(level) << kLevelShift |
           static_cast<std::uint64_t>(cell[2]) << (2 * kAxisBits) |
           static_cast<std::uint64_t>(cell[1]) << kAxisBits | static_cast<std::uint64_t>(cell[0]);
  }
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    mixed ^= mixed >> 32U;
    std::size_t slot = mixed & (slots_.size() - 1);
    while (slots_[slot] != kNone && entries_[slots_[slot]].first != key) {
      slot = (slot + 1) & (slots_.size() - 1);
    }
    return slot;
  }

  Vector3f low_;
  float smallest_mm_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
  std::vector<std::uint32_t> slots_;
  std::uint64_t levels_ = 0;
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> self_intersections(
    std::span<const Vector3f> positions, std::span<const Face> all_faces) {
  std::vector<Eigen::AlignedBox3f> boxes(all_faces.size());
  std::vector<std::uint32_t> faces;
  Eigen::AlignedBox3f all;
  double sizes = 0;
  for (std::uint32_t i = 0; i < all_faces.size(); ++i) {
    const Face& f = all_faces[i];
    if (std::any_of(f.begin(), f.end(), [&](std::uint32_t v) {
          return v >= positions.size() || !positions[v].allFinite();
        })) {
      continue;
    }
    for (const std::uint32_t v : f) {
      boxes[i].extend(positions[v]);
    }
    all.extend(boxes[i]);
    sizes += boxes[i].sizes().maxCoeff();
    faces.push_back(i);
  }
  if (faces.size() < 2 || !(sizes > 0)) {
    return {};
  }
  // So that no cell number of the finest level is cut off.
  constexpr float kMostCells = 400000.0F;
  const float smallest_mm = std::max(static_cast<float>(1.5 * sizes / static_cast<double>(faces.size())),
                                     all.sizes().maxCoeff() / kMostCells);
  const FaceCells cells(boxes, faces, all.min(), smallest_mm);
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pairs out = parallel_reduce_ordered(
      faces.size(), 4096, Pairs{},
      [&](std::size_t begin, std::size_t end) {
        Pairs found;
        for (std::size_t k = begin; k < end; ++k) {
          const std::uint32_t a = faces[k];
          const int level = cells.level_of(boxes[a]);
          cells.for_each_near(boxes[a], [&](std::uint32_t b) {
            if (a == b || (b < a && cells.level_of(boxes[b]) == level) || !boxes[a].intersects(boxes[b])) {
              return;
            }
            if (cut(positions, all_faces[a], all_faces[b])) {
              found.push_back(std::minmax(a, b));
            }
          });
        }
        return found;
      },
      [](Pairs& total, const Pairs& part) { total.insert(total.end(), part.begin(), part.end()); });
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace dubsar
