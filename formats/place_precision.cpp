// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/place_precision.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/keeps_places.h"
#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

std::unexpected<Error> refused(double farthest_mm, const char* too_far, const std::string& name) {
  return bad_input(name, "lies " + std::to_string(std::lround(farthest_mm / 1000.0)) + too_far, kMoveNear);
}

/// The middle of the vertices, along the axis on which it is farthest from the origin.
double farthest_of(const Mesh& mesh) {
  constexpr std::size_t kGrain = 65536;
  const Eigen::Vector3d sum = parallel_reduce_ordered(
      mesh.positions.size(), kGrain, Eigen::Vector3d(Eigen::Vector3d::Zero()),
      [&](std::size_t begin, std::size_t end) {
        Eigen::Vector3d part = Eigen::Vector3d::Zero();
        for (std::size_t v = begin; v < end; ++v) {
          part += mesh.positions[v].cast<double>();
        }
        return part;
      },
      [](Eigen::Vector3d& total, const Eigen::Vector3d& part) { total += part; });
  return mesh.positions.empty() ? 0 : sum.cwiseAbs().maxCoeff() / static_cast<double>(mesh.positions.size());
}

/// 0 where there is no face.
double median_edge_mm(const Mesh& mesh) {
  std::vector<float> edges_mm;
  edges_mm.reserve(3 * mesh.faces.size());
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges_mm.push_back((mesh.positions[face[(k + 1) % 3]] - mesh.positions[face[k]]).norm());
    }
  }
  return edges_mm.empty() ? 0 : static_cast<double>(median_of(std::move(edges_mm)));
}

}  // namespace

Status check_precision(const RangeGrid& grid, const std::string& name) {
  const std::size_t count = grid.valid_count();
  double farthest_mm = 0;
  for (const std::vector<float>* axis : {&grid.x, &grid.y, &grid.z}) {
    double sum = 0;
    for (std::size_t i = 0; i < axis->size(); ++i) {
      sum += grid.valid[i] != 0 ? static_cast<double>((*axis)[i]) : 0.0;
    }
    farthest_mm = std::max(farthest_mm, count == 0 ? 0.0 : std::abs(sum) / static_cast<double>(count));
  }
  if (keeps_places(farthest_mm, grid.spacing_mm)) {
    return {};
  }
  return refused(farthest_mm,
                 " m from the origin, too far for its samples to keep their places to a small part of their "
                 "spacing",
                 name);
}

Status check_precision(const Mesh& mesh, const std::string& name) {
  const double farthest_mm = farthest_of(mesh);
  // Edges are many: their median is looked for only where it matters.
  if (keeps_places(farthest_mm, 0) || keeps_places(farthest_mm, median_edge_mm(mesh))) {
    return {};
  }
  return refused(farthest_mm,
                 " m from the origin, too far for its vertices to keep their places to a small part of their "
                 "spacing",
                 name);
}

}  // namespace dubsar
