// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_mesh.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "triangulation/grid_triangulation.h"

namespace dubsar::bench {

namespace {

using Eigen::Vector3f;

/// In place: the mean of each value and those of its neighbours.
void smooth(std::vector<float>& values, const Neighbours& near) {
  std::vector<float> out(values.size());
  parallel_for_each_index(out.size(), [&](std::size_t v) {
    float sum = values[v];
    for (std::uint32_t k = near.first[v]; k < near.first[v + 1]; ++k) {
      sum += values[near.others[k]];
    }
    out[v] = sum / static_cast<float>(near.first[v + 1] - near.first[v] + 1);
  });
  values = std::move(out);
}

std::vector<float> reliability_of(const LinkMesh& mesh, const Neighbours& near) {
  std::vector<float> out(mesh.positions.size());
  parallel_for_each_index(out.size(), [&](std::size_t v) {
    float sum = 0;
    for (std::uint32_t k = near.first[v]; k < near.first[v + 1]; ++k) {
      sum += 1.0F / std::max((mesh.positions[near.others[k]] - mesh.positions[v]).norm(), 1e-6F);
    }
    out[v] = sum / static_cast<float>(std::max(near.first[v + 1] - near.first[v], 1U));
  });
  return out;
}

}  // namespace

Neighbours neighbours_of(const LinkMesh& mesh) {
  struct HalfEdge {
    std::uint32_t from, to;
  };
  std::vector<HalfEdge> edges(6 * mesh.faces.size());
  parallel_for_each_index(mesh.faces.size(), [&](std::size_t f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      edges[6 * f + 2 * k] = {a, b};
      edges[6 * f + 2 * k + 1] = {b, a};
    }
  });
  parallel_sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  Neighbours out;
  out.first.assign(mesh.positions.size() + 1, 0);
  out.is_boundary.assign(mesh.positions.size(), 0);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end].from == edges[i].from && edges[end].to == edges[i].to) {
      ++end;
    }
    out.others.push_back(edges[i].to);
    ++out.first[edges[i].from + 1];
    if (end - i == 1) {
      out.is_boundary[edges[i].from] = 1;
    }
    i = end;
  }
  for (std::size_t v = 0; v + 1 < out.first.size(); ++v) {
    out.first[v + 1] += out.first[v];
  }
  return out;
}

LinkMesh link_mesh(const PlacedScan& scan, int smoothing) {
  const RangeGrid& grid = *scan.grid;
  Mesh own = triangulate_grid(grid, scan.flags != nullptr ? *scan.flags : SampleFlags());
  LinkMesh out;
  out.faces = std::move(own.faces);
  out.positions.resize(own.positions.size());
  out.normals.resize(own.positions.size());
  out.to_scanner.resize(own.positions.size());
  const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
  std::size_t sample = 0;
  for (std::size_t v = 0; v < own.positions.size(); ++v, ++sample) {
    // The vertices are samples, in their order.
    while (grid.point(sample) != own.positions[v]) {
      ++sample;
    }
    const Eigen::Vector3d p = own.positions[v].cast<double>();
    out.positions[v] = (scan.model_from_scanner * p).cast<float>();
    out.normals[v] = rotation * own.normals[v];
    out.to_scanner[v] = rotation * grid.view.to_laser(p, grid.row_of(sample)).cast<float>();
  }
  const Neighbours near = neighbours_of(out);
  out.reliability = reliability_of(out, near);
  for (int k = 0; k < smoothing; ++k) {
    smooth(out.reliability, near);
  }
  out.weight = out.reliability;
  return out;
}

}  // namespace dubsar::bench
