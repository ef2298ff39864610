// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/correction_region.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/near_cells.h"

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
  NearCells near(apart);
  for (std::size_t v = 0; v < taken.size(); ++v) {
    const Eigen::Vector3d p = mesh.positions[v].cast<double>();
    if (taken[v] == 0 || !p.allFinite()) {
      continue;
    }
    if (std::ranges::any_of(near.about(p),
                            [&](std::size_t k) { return (out.region_mm[k] - p).norm() <= apart; })) {
      continue;
    }
    near.add(p, out.region_mm.size());
    out.region_mm.emplace_back((p / kMicrometre).array().round().matrix() * kMicrometre);
  }
  return out;
}

}  // namespace dubsar
