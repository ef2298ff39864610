// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/mesh.h"

namespace dubsar::shapes {

/// A unit sphere: an octahedron whose faces are split in four `levels` times.
inline Mesh unit_sphere(int levels) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] =
          middle.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (fresh) {
        mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
      }
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (const auto& [a, b, c] : mesh.faces) {
      const std::uint32_t ab = between(a, b);
      const std::uint32_t bc = between(b, c);
      const std::uint32_t ca = between(c, a);
      faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(faces);
  }
  return mesh;
}

inline Mesh scaled(Mesh mesh, const Eigen::Vector3f& by) {
  for (Eigen::Vector3f& p : mesh.positions) {
    p = p.cwiseProduct(by);
  }
  return mesh;
}

inline Mesh sphere(float radius_mm, int levels) {
  return scaled(unit_sphere(levels), Eigen::Vector3f::Constant(radius_mm));
}

/// A height field z(x, y) over [-half, half]² with `cells` cells a side, up being out.
template <class Height>
Mesh sheet(float half_mm, int cells, const Height& height) {
  Mesh mesh;
  const float step = 2 * half_mm / static_cast<float>(cells);
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const float px = -half_mm + step * static_cast<float>(x);
      const float py = -half_mm + step * static_cast<float>(y);
      mesh.positions.emplace_back(px, py, height(px, py));
    }
  }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (cells + 1) + x); };
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      mesh.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return mesh;
}

/// A closed box, its faces split into `cells` cells a side, its corners joined.
inline Mesh box(const Eigen::Vector3f& half_mm, int cells) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<int, 3>& k) {
    const auto [at, fresh] = known.try_emplace(k, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      mesh.positions.push_back(
          (Eigen::Vector3f(static_cast<float>(k[0]), static_cast<float>(k[1]), static_cast<float>(k[2])) *
               (2.0F / static_cast<float>(cells)) -
           Eigen::Vector3f::Ones())
              .cwiseProduct(half_mm));
    }
    return at->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int side : {0, cells}) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> k{};
            k[axis] = side;
            k[(axis + 1) % 3] = u;
            k[(axis + 2) % 3] = v;
            return vertex(k);
          };
          std::array<std::uint32_t, 4> quad{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0) {
            std::swap(quad[1], quad[3]);
          }
          mesh.faces.push_back({quad[0], quad[1], quad[2]});
          mesh.faces.push_back({quad[0], quad[2], quad[3]});
        }
      }
    }
  }
  return mesh;
}

}  // namespace dubsar::shapes
