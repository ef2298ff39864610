// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/correction_region.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace dubsar {

namespace {

/// Places stand so many edges of the mesh apart.
constexpr double kEdgesApart = 1.5;
constexpr double kMicrometre = 0.001;

/// Of the faces between the vertices; of the whole mesh's where there are none.
double mean_edge_mm(const Mesh& mesh, const std::vector<std::uint8_t>& taken) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& face : mesh.faces) {
    if (std::ranges::any_of(face, [&](std::uint32_t v) { return v >= taken.size() || taken[v] == 0; })) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      sum += static_cast<double>((mesh.positions[face[k]] - mesh.positions[face[(k + 1) % 3]]).norm());
      ++count;
    }
  }
  return count > 0 && std::isfinite(sum) ? sum / static_cast<double>(count) : 0.05;
}

}  // namespace

WedgeCorrection addition_of(const Mesh& mesh, const MeshSelection& selection) {
  const std::vector<std::uint8_t> taken = selected_vertices(mesh, selection);
  WedgeCorrection out;
  out.kind = CorrectionKind::kAdd;
  const double apart = kEdgesApart * mean_edge_mm(mesh, taken);
  out.reach_mm = std::ceil((apart + kMicrometre) / kMicrometre) * kMicrometre;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> near;  // places by cell and its neighbours
  const auto key_of = [&](const Eigen::Vector3d& p, int dx, int dy, int dz) {
    std::uint64_t key = 0;
    const int step[3] = {dx, dy, dz};
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::clamp(std::floor(p[axis] / apart), -1e6, 1e6) + step[axis];
      key = (key << 21U) | static_cast<std::uint64_t>(static_cast<std::int64_t>(at) + (1 << 20));
    }
    return key;
  };
  for (std::size_t v = 0; v < taken.size(); ++v) {
    const Eigen::Vector3d p = mesh.positions[v].cast<double>();
    if (taken[v] == 0 || !p.allFinite()) {
      continue;
    }
    const auto there = near.find(key_of(p, 0, 0, 0));
    if (there != near.end() && std::ranges::any_of(there->second, [&](std::size_t k) {
          return (out.region_mm[k] - p).norm() <= apart;
        })) {
      continue;
    }
    for (int k = 0; k < 27; ++k) {
      near[key_of(p, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)].push_back(out.region_mm.size());
    }
    out.region_mm.emplace_back((p / kMicrometre).array().round().matrix() * kMicrometre);
  }
  return out;
}

}  // namespace dubsar
