// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Of µ; measured on simulated tablets.
constexpr float kSigmaOfInterpolated = 0.4F;
constexpr std::size_t kGrain = 16384;

/// Cells of a raster, to be asked about often and seldom with success.
class CellSet {
 public:
  explicit CellSet(float cell_mm) : per_mm_(1.0F / cell_mm), maybe_(kBits / 64, 0) {}
  void insert_around(const Vector3f& p) {
    const auto [x, y, z] = cell_of(p);
    for (int n = 0; n < 27; ++n) {
      const std::uint64_t key = key_of(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1);
      keys_.insert(key);
      maybe_[bit_of(key) / 64] |= 1ULL << (bit_of(key) % 64);
    }
  }
  [[nodiscard]] bool contains(const Vector3f& p) const {
    const auto [x, y, z] = cell_of(p);
    const std::uint64_t key = key_of(x, y, z);
    return (maybe_[bit_of(key) / 64] >> (bit_of(key) % 64) & 1ULL) != 0 && keys_.contains(key);
  }

 private:
  static constexpr std::size_t kBits = std::size_t{1} << 20U;
  [[nodiscard]] std::array<int, 3> cell_of(const Vector3f& p) const {
    const auto cell = [&](float x) {
      return static_cast<int>(std::clamp(std::floor(x * per_mm_), -1.0e6F, 1.0e6F));
    };
    return {cell(p.x()), cell(p.y()), cell(p.z())};
  }
  [[nodiscard]] static std::uint64_t key_of(int x, int y, int z) {
    const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffffU; };
    return part(x) << 42U | part(y) << 21U | part(z);
  }
  [[nodiscard]] static std::size_t bit_of(std::uint64_t key) {
    const std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    return mixed >> 44U;
  }
  float per_mm_;
  std::vector<std::uint64_t> maybe_;
  std::unordered_set<std::uint64_t> keys_;
};

}  // namespace

std::vector<std::uint8_t> vertices_near(const Draft& draft, std::span<const std::uint32_t> seeds) {
  constexpr float kAroundSpacings = 6.0F;
  float reach_mm = 0;
  for (const std::uint32_t v : seeds) {
    reach_mm = std::max(reach_mm, kAroundSpacings * draft.spacing_mm(v));
  }
  std::vector<std::uint8_t> near(draft.mesh.positions.size(), 0);
  if (!(reach_mm > 0)) {
    return near;
  }
  CellSet cells(reach_mm);
  for (const std::uint32_t v : seeds) {
    cells.insert_around(draft.mesh.positions[v]);
  }
  parallel_for_each_index(
      near.size(), [&](std::size_t v) { near[v] = cells.contains(draft.mesh.positions[v]) ? 1 : 0; }, kGrain);
  return near;
}

Region::Region(const Draft& draft, std::span<const std::uint8_t> near) {
  const Mesh& mesh = draft.mesh;
  using Faces = std::vector<std::uint32_t>;
  faces_ = parallel_reduce_ordered(
      mesh.faces.size(), kGrain, Faces{},
      [&](std::size_t begin, std::size_t end) {
        Faces found;
        for (std::size_t i = begin; i < end; ++i) {
          const Triangle& f = mesh.faces[i];
          if ((near[f[0]] | near[f[1]] | near[f[2]]) != 0 && !is_gone(f)) {
            found.push_back(static_cast<std::uint32_t>(i));
          }
        }
        return found;
      },
      [](Faces& total, const Faces& part) { total.insert(total.end(), part.begin(), part.end()); });
  std::vector<std::uint32_t> local_of(mesh.positions.size(), 0);
  for (const std::uint32_t i : faces_) {
    for (const std::uint32_t v : mesh.faces[i]) {
      local_of[v] = 1;
    }
  }
  for (std::uint32_t v = 0; v < local_of.size(); ++v) {
    if (local_of[v] != 0) {
      local_of[v] = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
  }
  const std::size_t count = vertices_.size();
  sheet.positions.resize(count);
  sheet.normals.resize(count);
  sheet.spacing_mm.resize(count);
  sheet.whole.resize(count);
  parallel_for_each_index(
      count,
      [&](std::size_t k) {
        const std::uint32_t v = vertices_[k];
        sheet.positions[k] = mesh.positions[v];
        sheet.normals[k] = mesh.normals[v];
        sheet.spacing_mm[k] = draft.spacing_mm(v);
        sheet.whole[k] = near[v];
      },
      kGrain);
  sheet.faces.resize(faces_.size());
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    const Triangle& f = mesh.faces[faces_[k]];
    sheet.faces[k] = {local_of[f[0]], local_of[f[1]], local_of[f[2]]};
  }
}

std::uint32_t Region::local(std::uint32_t vertex) const {
  return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) -
                                    vertices_.begin());
}

void Region::erase(std::span<const std::uint8_t> gone, Draft& draft) {
  std::size_t out = 0;
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    if (gone[k] != 0) {
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
}

void Region::put_back(Draft& draft, std::size_t interpolated) const {
  Mesh& mesh = draft.mesh;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size() - vertices_.size());
  for (std::size_t k = vertices_.size(); k < sheet.positions.size(); ++k) {
    mesh.positions.push_back(sheet.positions[k]);
    mesh.normals.push_back(sheet.normals[k]);
    mesh.reliability.push_back(0);
    mesh.sigma_mm.push_back(kSigmaOfInterpolated * sheet.spacing_mm[k]);
    mesh.scans.push_back(0);
    mesh.flags.push_back(k >= interpolated ? kVertexInterpolated : 0);
    draft.added_spacing_mm.push_back(sheet.spacing_mm[k]);
    draft.near_rim.push_back(1);
  }
  for (std::size_t k = faces_.size(); k < sheet.faces.size(); ++k) {
    Triangle& f = mesh.faces.emplace_back(sheet.faces[k]);
    for (std::uint32_t& v : f) {
      v = v < vertices_.size() ? vertices_[v] : base + v;
      draft.near_rim[v] = 1;
    }
  }
}

}  // namespace dubsar
