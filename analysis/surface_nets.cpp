// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Gibson 1998 (surface nets), without the relaxation: the values are smooth already.
#include "analysis/surface_nets.h"

#include <array>

#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::uint32_t kNone = 0xffffffffU;

std::array<float, 8> corner_values(const NodeGrid& grid, const std::vector<float>& value, std::size_t node) {
  std::array<float, 8> corner{};
  for (std::size_t k = 0; k < 8; ++k) {
    corner[k] = value[node + (k & 1U) + ((k >> 1U) & 1U) * grid.row() + (k >> 2U) * grid.plane()];
  }
  return corner;
}

/// Where the surface lies in a cell, [0,1] each; false when it does not cross the cell.
bool crossing_mean(const std::array<float, 8>& corner, float level, Vector3f* mean) {
  Vector3f sum = Vector3f::Zero();
  float count = 0;
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t b = a | (std::size_t{1} << axis);
      if (b == a || (corner[a] > level) == (corner[b] > level)) {
        continue;
      }
      Vector3f at(static_cast<float>(a & 1U), static_cast<float>((a >> 1U) & 1U),
                  static_cast<float>(a >> 2U));
      at[static_cast<Eigen::Index>(axis)] = (level - corner[a]) / (corner[b] - corner[a]);
      sum += at;
      count += 1;
    }
  }
  if (count > 0) {
    *mean = sum / count;
  }
  return count > 0;
}

/// Out of the body: against the gradient of the trilinear values.
Vector3f outward(const std::array<float, 8>& c, const Vector3f& t) {
  const auto mix = [](float a, float b, float s) { return a + s * (b - a); };
  const float x0 = mix(mix(c[0], c[2], t.y()), mix(c[4], c[6], t.y()), t.z());
  const float x1 = mix(mix(c[1], c[3], t.y()), mix(c[5], c[7], t.y()), t.z());
  const float y0 = mix(mix(c[0], c[1], t.x()), mix(c[4], c[5], t.x()), t.z());
  const float y1 = mix(mix(c[2], c[3], t.x()), mix(c[6], c[7], t.x()), t.z());
  const float z0 = mix(mix(c[0], c[1], t.x()), mix(c[2], c[3], t.x()), t.y());
  const float z1 = mix(mix(c[4], c[5], t.x()), mix(c[6], c[7], t.x()), t.y());
  return Vector3f(x0 - x1, y0 - y1, z0 - z1).normalized();
}

}  // namespace

Mesh surface_nets(const NodeGrid& grid, const std::vector<float>& value, float level) {
  Mesh mesh;
  if (grid.nx < 2 || grid.ny < 2 || grid.nz < 2) {
    return mesh;
  }
  std::vector<std::uint32_t> vertex_of(grid.count(), kNone);
  const auto layers = static_cast<std::size_t>(grid.nz - 1);
  std::vector<Mesh> parts(layers);
  const auto each_cell = [&](std::size_t z, const auto& body) {
    for (int y = 0; y + 1 < grid.ny; ++y) {
      for (int x = 0; x + 1 < grid.nx; ++x) {
        body(x, y, static_cast<int>(z));
      }
    }
  };
  parallel_for_each_index(
      layers,
      [&](std::size_t layer) {
        each_cell(layer, [&](int x, int y, int z) {
          const std::size_t node = grid.index(x, y, z);
          const std::array<float, 8> corner = corner_values(grid, value, node);
          Vector3f mean;
          if (crossing_mean(corner, level, &mean)) {
            vertex_of[node] = static_cast<std::uint32_t>(parts[layer].positions.size());
            parts[layer].positions.push_back(grid.node_mm(x, y, z) + grid.cell_mm * mean);
            parts[layer].normals.push_back(outward(corner, mean));
          }
        });
      },
      1);
  std::vector<std::uint32_t> base(layers + 1, 0);
  for (std::size_t z = 0; z < layers; ++z) {
    base[z + 1] = base[z] + static_cast<std::uint32_t>(parts[z].positions.size());
    mesh.positions.insert(mesh.positions.end(), parts[z].positions.begin(), parts[z].positions.end());
    mesh.normals.insert(mesh.normals.end(), parts[z].normals.begin(), parts[z].normals.end());
  }
  const std::array<std::size_t, 3> step{1, grid.row(), grid.plane()};
  parallel_for_each_index(
      layers,
      [&](std::size_t layer) {
        each_cell(layer, [&](int x, int y, int z) {
          const std::size_t node = grid.index(x, y, z);
          const bool here = value[node] > level;
          const std::array<int, 3> at{x, y, z};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            // The four cells around the edge from this node along the axis.
            const std::size_t u = (axis + 1) % 3;
            const std::size_t w = (axis + 2) % 3;
            if (at[u] == 0 || at[w] == 0 || (value[node + step[axis]] > level) == here) {
              continue;
            }
            const auto vertex = [&](std::size_t cell) { return vertex_of[cell] + base[cell / grid.plane()]; };
            std::array<std::uint32_t, 4> quad{vertex(node), vertex(node - step[u]),
                                              vertex(node - step[u] - step[w]), vertex(node - step[w])};
            if (!here) {
              std::swap(quad[1], quad[3]);
            }
            parts[layer].faces.push_back({quad[0], quad[1], quad[2]});
            parts[layer].faces.push_back({quad[0], quad[2], quad[3]});
          }
        });
      },
      1);
  for (const Mesh& part : parts) {
    mesh.faces.insert(mesh.faces.end(), part.faces.begin(), part.faces.end());
  }
  return mesh;
}

}  // namespace dubsar
