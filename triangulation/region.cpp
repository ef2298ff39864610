// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/region.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::size_t kGrain = 16384;
constexpr std::uint32_t kNowhere = 0xffffffffU;

/// Cells of a raster over a box, as bits.
class CellSet {
 public:
  CellSet(const Eigen::AlignedBox3f& box, float cell_mm) : low_(box.min()) {
    constexpr float kMostPerAxis = 1000.0F;  // so that a million bits a layer are the most
    cell_mm = std::max(cell_mm, box.sizes().maxCoeff() / kMostPerAxis);
    per_mm_ = 1.0F / cell_mm;
    for (int k = 0; k < 3; ++k) {
      count_[k] = static_cast<int>(box.sizes()[k] * per_mm_) + 1;
    }
    bits_.assign((static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 63) / 64, 0);
  }
  [[nodiscard]] float cell_mm() const { return 1.0F / per_mm_; }
  [[nodiscard]] Eigen::Array3i cell_of(const Vector3f& p) const {
    return ((p - low_) * per_mm_).array().max(0.0F).cast<int>().min(count_ - 1);
  }
  void insert(const Eigen::Array3i& cell) {
    if ((cell >= 0).all() && (cell < count_).all()) {
      const std::size_t bit = bit_of(cell);
      bits_[bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
  [[nodiscard]] bool contains(const Eigen::Array3i& cell) const {
    const std::size_t bit = bit_of(cell);
    return (bits_[bit / 64] >> (bit % 64) & 1U) != 0;
  }

 private:
  [[nodiscard]] std::size_t bit_of(const Eigen::Array3i& cell) const {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(cell[0]);
  }
  Vector3f low_;
  float per_mm_ = 1;
  Eigen::Array3i count_{1, 1, 1};
  std::vector<std::uint64_t> bits_;
};

/// Steps from a cell to all that hold a point within `reach` cells' edges of one in it.
std::vector<Eigen::Array3i> steps_within(float reach) {
  std::vector<Eigen::Array3i> steps;
  const int most = static_cast<int>(reach) + 1;
  for (int z = -most; z <= most; ++z) {
    for (int y = -most; y <= most; ++y) {
      for (int x = -most; x <= most; ++x) {
        const Eigen::Array3i step(x, y, z);
        const Eigen::Array3f apart = (step.abs() - 1).max(0).cast<float>();
        if (apart.matrix().squaredNorm() <= reach * reach) {
          steps.push_back(step);
        }
      }
    }
  }
  return steps;
}

}  // namespace

std::vector<std::uint8_t> vertices_near(const Draft& draft, std::span<const std::uint32_t> seeds) {
  constexpr float kAroundSpacings = 6.0F;
  constexpr float kCellOfReach = 0.4F;
  float reach_mm = 0;
  for (const std::uint32_t v : seeds) {
    reach_mm = std::max(reach_mm, kAroundSpacings * draft.spacing_mm(v));
  }
  std::vector<std::uint8_t> near(draft.mesh.positions.size(), 0);
  if (!(reach_mm > 0)) {
    return near;
  }
  Eigen::AlignedBox3f box;
  for (const std::uint32_t v : seeds) {
    box.extend(draft.mesh.positions[v]);
  }
  const Vector3f margin = Vector3f::Constant(reach_mm);
  box = {box.min() - margin, box.max() + margin};
  CellSet seeded(box, kCellOfReach * reach_mm);
  CellSet cells = seeded;
  const std::vector<Eigen::Array3i> steps = steps_within(reach_mm / cells.cell_mm());
  for (const std::uint32_t v : seeds) {
    const Eigen::Array3i cell = cells.cell_of(draft.mesh.positions[v]);
    if (seeded.contains(cell)) {
      continue;
    }
    seeded.insert(cell);
    for (const Eigen::Array3i& step : steps) {
      cells.insert(cell + step);
    }
  }
  parallel_for_each_index(
      near.size(),
      [&](std::size_t v) {
        const Vector3f& p = draft.mesh.positions[v];
        near[v] = box.contains(p) && cells.contains(cells.cell_of(p)) ? 1 : 0;
      },
      kGrain);
  return near;
}

std::vector<Region> take_regions(const Draft& draft, std::span<const std::uint8_t> near,
                                 const Tiling& tiling) {
  const Mesh& mesh = draft.mesh;
  struct Entry {
    std::uint32_t tile, item;
  };
  using Entries = std::vector<Entry>;
  const auto join = [](Entries& total, const Entries& part) {
    total.insert(total.end(), part.begin(), part.end());
  };
  std::vector<std::uint32_t> tile_of(mesh.positions.size());  // kNowhere: not near
  const Entries vertices = parallel_reduce_ordered(
      mesh.positions.size(), kGrain, Entries{},
      [&](std::size_t begin, std::size_t end) {
        Entries found;
        for (std::size_t v = begin; v < end; ++v) {
          tile_of[v] = kNowhere;
          if (near[v] != 0) {
            tile_of[v] = static_cast<std::uint32_t>(tiling.tile_of(mesh.positions[v]));
            found.push_back({tile_of[v], static_cast<std::uint32_t>(v)});
          }
        }
        return found;
      },
      join);
  const Entries faces = parallel_reduce_ordered(
      mesh.faces.size(), kGrain, Entries{},
      [&](std::size_t begin, std::size_t end) {
        Entries found;
        for (std::size_t i = begin; i < end; ++i) {
          const Triangle& f = mesh.faces[i];
          if ((near[f[0]] | near[f[1]] | near[f[2]]) == 0 || is_gone(f)) {
            continue;
          }
          const std::uint32_t a = tile_of[f[0]], b = tile_of[f[1]], c = tile_of[f[2]];
          if (a != kNowhere) {
            found.push_back({a, static_cast<std::uint32_t>(i)});
          }
          if (b != kNowhere && b != a) {
            found.push_back({b, static_cast<std::uint32_t>(i)});
          }
          if (c != kNowhere && c != a && c != b) {
            found.push_back({c, static_cast<std::uint32_t>(i)});
          }
        }
        return found;
      },
      join);
  std::vector<Region> by_tile(tiling.size());
  std::vector<std::uint32_t> local_of(mesh.positions.size());
  for (const auto& [tile, v] : vertices) {
    local_of[v] = static_cast<std::uint32_t>(by_tile[tile].vertices_.size());
    by_tile[tile].vertices_.push_back(v);
  }
  for (const auto& [tile, face] : faces) {
    by_tile[tile].faces_.push_back(face);
  }
  parallel_for_each_index(
      by_tile.size(),
      [&](std::size_t tile) { by_tile[tile].fill(draft, local_of, tile_of, tiling.box(tile), tile); }, 1);
  std::erase_if(by_tile, [](const Region& region) { return region.faces_.empty(); });
  return by_tile;
}

void Region::fill(const Draft& draft, std::span<const std::uint32_t> local_of,
                  std::span<const std::uint32_t> tile_of, const Eigen::AlignedBox3f& room, std::size_t tile) {
  const Mesh& mesh = draft.mesh;
  tile_ = tile;
  whole_ = vertices_.size();
  const auto is_whole = [&](std::uint32_t v) { return tile_of[v] == tile; };
  std::vector<std::uint32_t> rest;
  for (const std::uint32_t i : faces_) {
    for (const std::uint32_t v : mesh.faces[i]) {
      if (!is_whole(v)) {
        rest.push_back(v);
      }
    }
  }
  std::sort(rest.begin(), rest.end());
  rest.erase(std::unique(rest.begin(), rest.end()), rest.end());
  vertices_.insert(vertices_.end(), rest.begin(), rest.end());
  const std::size_t count = vertices_.size();
  sheet.room = room;
  sheet.positions.resize(count);
  sheet.normals.resize(count);
  sheet.spacing_mm.resize(count);
  sheet.sigma_mm.resize(count);
  sheet.marks.resize(count);
  sheet.whole.resize(count);
  parallel_for_each_index(
      count,
      [&](std::size_t k) {
        const std::uint32_t v = vertices_[k];
        sheet.positions[k] = mesh.positions[v];
        sheet.normals[k] = mesh.normals[v];
        sheet.spacing_mm[k] = draft.spacing_mm(v);
        sheet.sigma_mm[k] = mesh.sigma_mm[v];
        const bool is_loose = k < whole_ && draft.near_rim[v] == Draft::kLoose;
        const bool is_sparse = v < mesh.flags.size() && (mesh.flags[v] & kVertexSparse) != 0;
        sheet.marks[k] =
            static_cast<std::uint8_t>((is_loose ? kLooseMark : 0) | (is_sparse ? kSparseMark : 0));
        sheet.whole[k] = k < whole_ ? 1 : 0;
      },
      kGrain);
  sheet.faces.resize(faces_.size());
  parallel_for_each_index(
      faces_.size(),
      [&](std::size_t k) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::uint32_t v = mesh.faces[faces_[k]][corner];
          const auto among_rest = [&] {
            return std::lower_bound(rest.begin(), rest.end(), v) - rest.begin();
          };
          sheet.faces[k][corner] =
              is_whole(v) ? local_of[v]
                          : static_cast<std::uint32_t>(whole_) + static_cast<std::uint32_t>(among_rest());
        }
      },
      kGrain);
  for (const Triangle& f : sheet.faces) {
    for (const std::uint32_t v : f) {
      sheet.marks[v] &= kSparseMark;
    }
  }
}

std::uint32_t Region::local(std::uint32_t vertex) const {
  const auto end = vertices_.begin() + static_cast<std::ptrdiff_t>(whole_);
  return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), end, vertex) - vertices_.begin());
}

std::size_t Region::erase(std::span<const std::uint8_t> gone, Draft& draft) {
  std::size_t out = 0;
  const std::size_t before = faces_.size();
  for (std::size_t k = 0; k < before; ++k) {
    const bool inside = std::all_of(sheet.faces[k].begin(), sheet.faces[k].end(),
                                    [&](std::uint32_t v) { return sheet.has_room(sheet.positions[v], 0); });
    if (gone[k] != 0 && inside) {
      Triangle& f = draft.mesh.faces[faces_[k]];
      for (const std::uint32_t v : f) {
        draft.near_rim[v] = Draft::kAtRim;
      }
      f[1] = f[2] = f[0];
    } else {
      sheet.faces[out] = sheet.faces[k];
      faces_[out++] = faces_[k];
    }
  }
  sheet.faces.resize(out);
  faces_.resize(out);
  return before - out;
}

void Region::put_back(Draft& draft, std::size_t interpolated) const {
  Mesh& mesh = draft.mesh;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size() - vertices_.size());
  for (std::size_t k = vertices_.size(); k < sheet.positions.size(); ++k) {
    mesh.positions.push_back(sheet.positions[k]);
    mesh.normals.push_back(sheet.normals[k]);
    mesh.reliability.push_back(0);
    mesh.sigma_mm.push_back(sheet.sigma_mm[k]);
    mesh.scans.push_back(0);
    mesh.flags.push_back(k >= interpolated ? kVertexInterpolated : 0);
    draft.added_spacing_mm.push_back(sheet.spacing_mm[k]);
    draft.near_rim.push_back(1);
  }
  for (std::size_t k = faces_.size(); k < sheet.faces.size(); ++k) {
    Triangle& f = mesh.faces.emplace_back(sheet.faces[k]);
    for (std::uint32_t& v : f) {
      v = v < vertices_.size() ? vertices_[v] : base + v;
      draft.near_rim[v] = std::max<std::uint8_t>(draft.near_rim[v], 1);  // the rim of a patch stays one
    }
  }
}

}  // namespace dubsar
