// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/parted_fans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel_erase.h"
#include "core/parallel_sort.h"
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
    if (!mesh.colours.empty()) {
      mesh.colours.push_back(std::array<std::uint8_t, 3>(mesh.colours[v]));
    }
    draft.added_spacing_mm.push_back(draft.spacing_mm(v));
    draft.near_rim.push_back(1);
  }
}

/// What a compressed file of the mesh may keep of places: 23 bits of the way that they reach, and nothing
/// below 2^-16 mm (formats/draco_mesh.h).
double step_of_files_mm(std::span<const Vector3f> positions) {
  constexpr double kMostSteps = 0x1p23;
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : positions) {
    box.extend(p);
  }
  const double farthest_mm =
      std::max({box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff(), box.sizes().maxCoeff()});
  double step_mm = 0x1p-16;
  while (farthest_mm > step_mm * kMostSteps) {
    step_mm *= 2;
  }
  return step_mm;
}

/// The place of a vertex a thousandth of the way, or so much more as takes it `least_mm` along an axis, or as
/// there are numbers for where that is too far; the vertex's own where there are none.
Vector3f drawn(const Vector3f& p, const Eigen::Vector3d& way, double least_mm) {
  constexpr double kMost = 0.1;
  Vector3f nearest = p;
  for (double part = 1e-3; part < kMost; part *= 2) {
    const Vector3f q = (p.cast<double>() + part * way).cast<float>();
    if ((q - p).cwiseAbs().maxCoeff() >= static_cast<float>(least_mm)) {
      return q;
    }
    nearest = nearest == p ? q : nearest;
  }
  return nearest;
}

std::uint64_t hash_of(const Vector3f& p) {
  std::uint64_t hash = 0;
  for (const float x : p) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(x + 0.0F)) * 0x9e3779b97f4a7c15ULL;  // -0 is 0
    hash ^= hash >> 29U;
  }
  return hash;
}

/// Vertices near rims that lie where one before them does: samples of two scans may coincide.
std::vector<std::uint32_t> in_a_place_taken(const Draft& draft) {
  const std::vector<Vector3f>& p = draft.mesh.positions;
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(draft.near_rim, [](std::uint8_t near) { return near != 0; }));
  // First by one bit of many for each place: few are left to be sorted.
  const std::size_t bits = std::bit_ceil(16 * count + 64);
  std::vector<std::uint64_t> once(bits / 64, 0), again(bits / 64, 0);
  const auto for_each_near = [&](const auto& visit) {
    for (std::size_t v = 0; v < p.size(); ++v) {
      if (draft.near_rim[v] != 0) {
        const std::uint64_t hash = hash_of(p[v]);
        const std::uint64_t bit = (hash ^ (hash >> 32U)) & (bits - 1);
        visit(static_cast<std::uint32_t>(v), hash, bit / 64, std::uint64_t{1} << (bit % 64));
      }
    }
  };
  for_each_near([&](std::uint32_t, std::uint64_t, std::size_t word, std::uint64_t bit) {
    again[word] |= once[word] & bit;
    once[word] |= bit;
  });
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;
  for_each_near([&](std::uint32_t v, std::uint64_t hash, std::size_t word, std::uint64_t bit) {
    if ((again[word] & bit) != 0) {
      places.emplace_back(hash, v);
    }
  });
  parallel_sort(places.begin(), places.end(), std::less<>());
  std::vector<std::uint32_t> taken;
  for (std::size_t k = 1; k < places.size(); ++k) {
    if (places[k].first == places[k - 1].first && p[places[k].second] == p[places[k - 1].second]) {
      taken.push_back(places[k].second);
    }
  }
  std::ranges::sort(taken);
  return taken;
}

/// Draws the vertices (ascending) into their fans. [V] 1 for those that stay where they were.
/// `faces`: all that have one of them.
std::vector<std::uint8_t> draw_apart(Mesh& mesh, std::span<const Triangle> faces,
                                     std::span<const std::uint32_t> moved) {
  std::vector<std::uint8_t> moves(mesh.positions.size(), 0);
  for (const std::uint32_t v : moved) {
    moves[v] = 1;
  }
  struct Around {
    Eigen::Vector3d sum{0, 0, 0};
    int count = 0;
  };
  std::vector<Around> around(moved.size());
  for (const Triangle& f : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (moves[f[k]] != 0) {
        Around& at = around[static_cast<std::size_t>(std::ranges::lower_bound(moved, f[k]) - moved.begin())];
        at.sum += (mesh.positions[f[(k + 1) % 3]] + mesh.positions[f[(k + 2) % 3]]).cast<double>();
        at.count += 2;
      }
    }
  }
  // What lies one step apart such a file keeps apart, two for what is rounded on the way into it.
  const double least_mm = 2 * step_of_files_mm(mesh.positions);
  std::vector<std::uint8_t> stays(mesh.positions.size(), 0);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    Vector3f& p = mesh.positions[moved[k]];
    const Vector3f q =
        around[k].count == 0 ? p : drawn(p, around[k].sum / around[k].count - p.cast<double>(), least_mm);
    stays[moved[k]] = q == p ? 1 : 0;
    p = q;
  }
  return stays;
}

std::vector<Triangle> faces_with(const Mesh& mesh, std::span<const std::uint8_t> near) {
  std::vector<Triangle> faces;
  for (const Triangle& f : mesh.faces) {
    if ((near[f[0]] | near[f[1]] | near[f[2]]) != 0) {
      faces.push_back(f);
    }
  }
  return faces;
}

/// Marks those of the moved vertices that a face has which cuts another.
void mark_cutting(const Mesh& mesh, std::span<const Triangle> faces, std::span<const std::uint32_t> moved,
                  std::vector<std::uint8_t>& marked, const JobContext& job) {
  for (const auto& [a, b] : self_intersections(mesh.positions, faces, {}, job)) {
    for (const std::uint32_t face : {a, b}) {
      for (const std::uint32_t v : faces[face]) {
        if (std::ranges::binary_search(moved, v)) {
          marked[v] = 1;
        }
      }
    }
  }
}

}  // namespace

void part_fans(Draft& draft, const JobContext& job) {
  Mesh& mesh = draft.mesh;
  std::vector<std::uint8_t> near = draft.near_rim;  // elsewhere faces are those of grids
  // Where fans go others beside them may part: until none is left, for there are fewer faces each time.
  while (!job.cancelled()) {
    append_copies(draft, make_manifold(mesh.faces, mesh.positions.size(), near, job));
    if (job.cancelled()) {
      return;
    }
    const std::vector<std::uint32_t> moved = in_a_place_taken(draft);
    if (moved.empty()) {
      return;
    }
    near = vertices_near(draft, moved);
    const std::vector<Triangle> faces = faces_with(mesh, near);
    std::vector<std::uint8_t> goes = draw_apart(mesh, faces, moved);
    mark_cutting(mesh, faces, moved, goes, job);
    const std::size_t before = mesh.faces.size();
    erase_where(mesh.faces, [&](const Triangle& f) { return (goes[f[0]] | goes[f[1]] | goes[f[2]]) != 0; });
    if (mesh.faces.size() == before) {
      return;
    }
  }
}

}  // namespace dubsar
