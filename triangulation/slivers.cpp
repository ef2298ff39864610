// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/slivers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/units.h"
#include "triangulation/region.h"
#include "triangulation/triangle_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;
using Positions = std::span<const Eigen::Vector3f>;

constexpr int kMostRounds = 4;
constexpr double kLeastGain = 1.3;
/// How far the corner across from the edge may lie off the other face's plane, of the edge's length: no more
/// is a sharp edge displaced.
constexpr double kMostOffPlane = 0.04;

double least_tangent_of(Positions positions, const Triangle& f) {
  return least_tangent(positions[f[0]].cast<double>(), positions[f[1]].cast<double>(),
                       positions[f[2]].cast<double>());
}

bool is_sliver(Positions positions, const Triangle& f) {
  static const double below = std::tan(rad_from_deg(10.0));
  return !is_gone(f) && least_tangent_of(positions, f) < below;
}

Vector3d cross_of(Positions positions, const Triangle& f) {
  const Vector3d a = positions[f[0]].cast<double>();
  return (positions[f[1]].cast<double>() - a).cross(positions[f[2]].cast<double>() - a);
}

/// The face from the corner that its longest edge lies across from.
Triangle from_widest_corner(Positions positions, const Triangle& f) {
  std::array<float, 3> across{};
  for (std::size_t k = 0; k < 3; ++k) {
    across[k] = (positions[f[(k + 1) % 3]] - positions[f[(k + 2) % 3]]).squaredNorm();
  }
  const auto k = static_cast<std::size_t>(std::ranges::max_element(across) - across.begin());
  return {f[k], f[(k + 1) % 3], f[(k + 2) % 3]};
}

/// The two faces that take the place of face abc and the one beyond its edge bc; nothing where they are no
/// better.
std::optional<std::array<Triangle, 2>> flipped(const Sheet& sheet, const HalfEdges& edges,
                                               const Triangle& sliver, const Triangle& beyond) {
  const auto [a, b, c] = sliver;
  const std::size_t at = beyond[0] == c ? 2 : beyond[1] == c ? 0 : 1;  // c, b, then its own
  const std::uint32_t d = beyond[at];
  const auto holds_d = [&](const HalfEdges::Out& out) {
    return std::ranges::find(sheet.faces[out.face], d) != sheet.faces[out.face].end();
  };
  if (std::ranges::any_of(edges.from(a), holds_d)) {
    return std::nullopt;
  }
  const Positions p = sheet.positions;
  const std::array<Triangle, 2> faces = {Triangle{a, b, d}, Triangle{a, d, c}};
  const double before = std::min(least_tangent_of(p, sliver), least_tangent_of(p, beyond));
  const double after = std::min(least_tangent_of(p, faces[0]), least_tangent_of(p, faces[1]));
  const Vector3d plane = cross_of(p, beyond).normalized();
  const double off_mm = std::abs(plane.dot((p[a] - p[b]).cast<double>()));
  const auto faces_alike = [&](const Triangle& f) {
    const Vector3d n = cross_of(p, f);
    return n.dot(plane) > 0.5 * n.norm();
  };
  if (!(after > kLeastGain * before) || off_mm > kMostOffPlane * (p[c] - p[b]).cast<double>().norm() ||
      !faces_alike(faces[0]) || !faces_alike(faces[1])) {
    return std::nullopt;
  }
  return faces;
}

/// Flips what can be flipped side by side; returns how many.
std::size_t flip_once(Region& region, Draft& draft, std::span<const std::uint32_t> slivers) {
  const Sheet& sheet = region.sheet;
  const HalfEdges edges(sheet.faces, sheet.positions.size());
  std::vector<std::uint8_t> gone(sheet.faces.size(), 0);
  std::vector<std::uint8_t> touched(sheet.positions.size(), 0);
  std::vector<Triangle> added;
  std::size_t count = 0;
  const auto is_free = [&](const Triangle& f) {
    return std::ranges::none_of(f, [&](std::uint32_t v) { return touched[v] != 0; });
  };
  const auto touch = [&](const Triangle& f) {
    for (const std::uint32_t v : f) {
      touched[v] = 1;
    }
  };
  const auto is_inner = [&](std::uint32_t v) {
    return std::ranges::all_of(edges.from(v),
                               [&](const HalfEdges::Out& out) { return edges.face(out.to, v) >= 0; });
  };
  for (std::size_t k = 0; k < sheet.faces.size(); ++k) {
    if (!std::ranges::binary_search(slivers, region.face(k)) || !is_free(sheet.faces[k])) {
      continue;
    }
    const Triangle sliver = from_widest_corner(sheet.positions, sheet.faces[k]);
    const std::int64_t beyond = edges.face(sliver[2], sliver[1]);
    if (beyond < 0) {
      // Its corner comes to the rim: nowhere else may it lie on one.
      if (is_inner(sliver[0])) {
        gone[k] = 1;
        touch(sliver);
        ++count;
      }
      continue;
    }
    const Triangle& other = sheet.faces[static_cast<std::size_t>(beyond)];
    if (!is_free(other)) {
      continue;
    }
    if (const auto faces = flipped(sheet, edges, sliver, other)) {
      gone[k] = gone[static_cast<std::size_t>(beyond)] = 1;
      touch(sliver);
      touch(other);
      added.insert(added.end(), faces->begin(), faces->end());
      ++count;
    }
  }
  region.erase(gone, draft);
  region.sheet.faces.insert(region.sheet.faces.end(), added.begin(), added.end());
  region.put_back(draft, sheet.positions.size());
  return count;
}

std::vector<std::uint32_t> slivers_from(const Draft& draft, std::size_t first_face) {
  const std::vector<Triangle>& faces = draft.mesh.faces;
  using Faces = std::vector<std::uint32_t>;
  return parallel_reduce_ordered(
      faces.size() - first_face, 16384, Faces{},
      [&](std::size_t begin, std::size_t end) {
        Faces found;
        for (std::size_t f = first_face + begin; f < first_face + end; ++f) {
          if (is_sliver(draft.mesh.positions, faces[f])) {
            found.push_back(static_cast<std::uint32_t>(f));
          }
        }
        return found;
      },
      [](Faces& total, const Faces& part) { total.insert(total.end(), part.begin(), part.end()); });
}

}  // namespace

std::size_t remove_slivers(Draft& draft, std::size_t first_face, const JobContext& job) {
  std::size_t all = 0;
  for (int round = 0; round < kMostRounds && !job.cancelled(); ++round) {
    const std::vector<std::uint32_t> slivers = slivers_from(draft, first_face);
    if (slivers.empty()) {
      break;
    }
    std::vector<std::uint8_t> near(draft.mesh.positions.size(), 0);
    for (const std::uint32_t f : slivers) {
      for (const std::uint32_t v : draft.mesh.faces[f]) {
        near[v] = 1;
      }
    }
    std::size_t flips = 0;
    for (Region& region : take_regions(draft, near, Tiling())) {
      if (!job.cancelled()) {
        flips += flip_once(region, draft, slivers);
      }
    }
    all += flips;
    if (flips == 0) {
      break;
    }
  }
  return all;
}

}  // namespace dubsar
