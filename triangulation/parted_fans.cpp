// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/parted_fans.h"

#include <algorithm>
#include <vector>

#include "core/parallel_erase.h"
#include "triangulation/manifold.h"
#include "triangulation/region.h"
#include "triangulation/self_intersections.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

void append_copies(Draft& draft, std::span<const std::uint32_t> copied) {
  Mesh& mesh = draft.mesh;
  for (const std::uint32_t v : copied) {
    mesh.positions.push_back(Vector3f(mesh.positions[v]));
    mesh.normals.push_back(Vector3f(mesh.normals[v]));
    mesh.reliability.push_back(float(mesh.reliability[v]));
    mesh.sigma_mm.push_back(float(mesh.sigma_mm[v]));
    mesh.scans.push_back(std::uint8_t(mesh.scans[v]));
    mesh.flags.push_back(std::uint8_t(mesh.flags[v]));
    draft.added_spacing_mm.push_back(draft.spacing_mm(v));
    draft.near_rim.push_back(1);
  }
}

/// The place of a vertex a thousandth of the way, or so much more as there are numbers for; the vertex's own
/// where there are none.
Vector3f drawn(const Vector3f& p, const Eigen::Vector3d& way) {
  constexpr double kMost = 0.1;
  for (double part = 1e-3; part < kMost; part *= 2) {
    const Vector3f q = (p.cast<double>() + part * way).cast<float>();
    if (q != p) {
      return q;
    }
  }
  return p;
}

/// Draws the vertices from `first` on into their fans. [vertices - first] 1 for those that stay where they
/// were.
std::vector<std::uint8_t> draw_apart(Mesh& mesh, std::size_t first) {
  struct Around {
    Eigen::Vector3d sum{0, 0, 0};
    int count = 0;
  };
  std::vector<Around> around(mesh.positions.size() - first);
  for (const Triangle& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (f[k] >= first) {
        Around& at = around[f[k] - first];
        at.sum += (mesh.positions[f[(k + 1) % 3]] + mesh.positions[f[(k + 2) % 3]]).cast<double>();
        at.count += 2;
      }
    }
  }
  std::vector<std::uint8_t> stays(around.size(), 0);
  for (std::size_t k = 0; k < around.size(); ++k) {
    Vector3f& p = mesh.positions[first + k];
    const Vector3f q = drawn(p, around[k].sum / std::max(around[k].count, 1) - p.cast<double>());
    stays[k] = q == p ? 1 : 0;
    p = q;
  }
  return stays;
}

/// Marks the vertices from `first` on that a face has which cuts another, of those with a near vertex.
void mark_cutting(const Mesh& mesh, std::span<const std::uint8_t> near, std::size_t first,
                  std::vector<std::uint8_t>& marked) {
  std::vector<Triangle> faces;
  for (const Triangle& f : mesh.faces) {
    if (std::ranges::any_of(f, [&](std::uint32_t v) { return v >= first || near[v] != 0; })) {
      faces.push_back(f);
    }
  }
  for (const auto& [a, b] : self_intersections(mesh.positions, faces)) {
    for (const std::uint32_t face : {a, b}) {
      for (const std::uint32_t v : faces[face]) {
        if (v >= first) {
          marked[v - first] = 1;
        }
      }
    }
  }
}

}  // namespace

void part_fans(Draft& draft) {
  Mesh& mesh = draft.mesh;
  // Where fans go others may part: until none is left, for there are fewer faces each time.
  while (true) {
    // Elsewhere faces are those of grids.
    const std::vector<std::uint32_t> copied =
        make_manifold(mesh.faces, mesh.positions.size(), draft.near_rim);
    if (copied.empty()) {
      return;
    }
    const std::vector<std::uint8_t> near = vertices_near(draft, copied);
    const std::size_t first = mesh.positions.size();
    append_copies(draft, copied);
    std::vector<std::uint8_t> goes = draw_apart(mesh, first);
    mark_cutting(mesh, near, first, goes);
    const std::size_t before = mesh.faces.size();
    erase_where(mesh.faces, [&](const Triangle& f) {
      return std::ranges::any_of(f, [&](std::uint32_t v) { return v >= first && goes[v - first] != 0; });
    });
    if (mesh.faces.size() == before) {
      return;
    }
  }
}

}  // namespace dubsar
