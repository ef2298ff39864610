// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/vertex_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/inside_out.h"
#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

constexpr std::size_t kGrain = 1U << 14U;
/// A face whose normal stands this much (cosine) against the sum of all at the vertex is taken to be flipped.
constexpr float kAgainst = -0.3F;

Eigen::Vector3f twice_area(const Mesh& mesh, std::uint32_t face) {
  const auto& f = mesh.faces[face];
  const Eigen::Vector3f& a = mesh.positions[f[0]];
  return (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a);
}

/// A part of the mesh that hangs together and has this share of its area is looked at by itself.
constexpr double kLargePart = 0.05;
/// One that has no more than this is a scrap: it must not move the box, and with it the grids, of the rest.
constexpr double kScrap = 0.001;

struct Sums {
  double area = 0;
  double edges = 0;
  double edge_count = 0;
};

void join(Sums& into, const Sums& s) {
  into.area += s.area;
  into.edges += s.edges;
  into.edge_count += s.edge_count;
}

/// Of some of the vertices, by area.
struct FacingSums {
  double area = 0;
  Eigen::Vector3d centre{0, 0, 0};
  Eigen::Vector3d normals{0, 0, 0};
  double outward = 0;  ///< of normal · (p − centre)
  double spread = 0;   ///< of |p − centre|
};

void join(FacingSums& into, const FacingSums& s) {
  into.area += s.area;
  into.centre += s.centre;
  into.normals += s.normals;
  into.outward += s.outward;
  into.spread += s.spread;
}

/// Whether the faces of these vertices run clockwise seen from outside.
template <class IsOne>
bool looks_inward(const Mesh& mesh, const VertexGeometry& geometry, const IsOne& is_one) {
  const auto sum = [&](const auto& add) {
    return parallel_reduce_ordered(
        mesh.positions.size(), kGrain, FacingSums{},
        [&](std::size_t begin, std::size_t end) {
          FacingSums sums;
          for (std::size_t i = begin; i < end; ++i) {
            if (geometry.area_mm2[i] > 0 && is_one(i)) {
              add(i, sums);
            }
          }
          return sums;
        },
        [](FacingSums& into, const FacingSums& s) { join(into, s); });
  };
  const FacingSums first = sum([&](std::size_t i, FacingSums& to) {
    const double area = geometry.area_mm2[i];
    to.area += area;
    to.centre += area * mesh.positions[i].cast<double>();
  });
  const Eigen::Vector3f centre = (first.centre / first.area).cast<float>();
  const FacingSums second = sum([&](std::size_t i, FacingSums& to) {
    const Eigen::Vector3f away = mesh.positions[i] - centre;
    to.normals += (geometry.area_mm2[i] * geometry.normal[i]).cast<double>();
    to.outward += geometry.area_mm2[i] * away.dot(geometry.normal[i]);
    to.spread += geometry.area_mm2[i] * away.norm();
  });
  return Facing{first.area, second.normals, second.outward, second.spread}.is_inward();
}

/// Turns the normals that look into the clay: of each large part by itself (two fragments in one file may run
/// either way), of the scraps as of the whole.
void turn_outward(const Mesh& mesh, VertexGeometry* geometry) {
  geometry->turned = looks_inward(mesh, *geometry, [](std::size_t) { return true; });
  const MeshParts& parts = geometry->parts;
  const std::vector<std::uint32_t> large = parts.larger_than(kLargePart);
  std::vector<bool> turned(mesh.positions.size(), geometry->turned);
  if (large.size() > 1) {
    for (const std::uint32_t part : large) {
      turned[part] = looks_inward(mesh, *geometry, [&](std::size_t i) { return parts.of[i] == part; });
    }
  }
  parallel_for_each_index(
      mesh.positions.size(),
      [&](std::size_t i) {
        if (turned[parts.of[i]]) {
          geometry->normal[i] = -geometry->normal[i];
        }
      },
      kGrain);
}

/// The area-weighted normal at v and a third of the area; a flipped face counts the right way round.
void at_vertex(const Mesh& mesh, std::span<const std::uint32_t> faces, Eigen::Vector3f* normal, float* area) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float whole = 0;
  for (const std::uint32_t f : faces) {
    const Eigen::Vector3f n = twice_area(mesh, f);
    sum += n;
    whole += n.norm();
  }
  float length = sum.norm();
  if (length < 0.7F * whole && length > 0) {
    Eigen::Vector3f turned = Eigen::Vector3f::Zero();
    for (const std::uint32_t f : faces) {
      const Eigen::Vector3f n = twice_area(mesh, f);
      turned += n.dot(sum) < kAgainst * n.norm() * length ? Eigen::Vector3f(-n) : n;
    }
    sum = turned;
    length = sum.norm();
  }
  *normal = length > 0 && std::isfinite(length) ? Eigen::Vector3f(sum / length) : Eigen::Vector3f::Zero();
  *area = std::isfinite(whole) ? whole / 6.0F : 0.0F;
}

/// [V] whether the vertex has an area, but for those of scraps, unless scraps are most there is.
std::vector<bool> of_no_scrap(const VertexGeometry& geometry) {
  const MeshParts& parts = geometry.parts;
  std::vector<bool> is_large(parts.of.size(), false);
  double area_mm2 = 0;
  for (const std::uint32_t part : parts.larger_than(kScrap)) {
    is_large[part] = true;
    area_mm2 += parts.area_mm2[part];
  }
  const bool all = area_mm2 < 0.5 * geometry.total_area_mm2;
  std::vector<bool> counts(parts.of.size());
  for (std::size_t v = 0; v < counts.size(); ++v) {
    counts[v] = geometry.area_mm2[v] > 0 && (all || is_large[parts.of[v]]);
  }
  return counts;
}

/// Evenly taken from those that count, about so many: vertices of no face, left over by another program,
/// change nothing.
std::vector<std::uint32_t> some_of(const std::vector<bool>& counts, std::size_t about) {
  const auto count = static_cast<std::size_t>(std::ranges::count(counts, true));
  const std::size_t stride = std::max<std::size_t>(1, count / about);
  std::vector<std::uint32_t> some;
  some.reserve(count / stride + 1);
  std::size_t k = 0;
  for (std::size_t v = 0; v < counts.size(); ++v) {
    if (counts[v] && k++ % stride == 0) {
      some.push_back(static_cast<std::uint32_t>(v));
    }
  }
  return some;
}

Eigen::AlignedBox3f box_without_strays(const Mesh& mesh, const std::vector<bool>& counts,
                                       double mean_edge_mm) {
  constexpr std::size_t kSampled = 200000;
  constexpr double kStray = 0.001;
  constexpr float kBeyond = 0.05F;
  Eigen::AlignedBox3f whole;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (counts[v]) {
      whole.extend(mesh.positions[v]);
    }
  }
  std::array<std::vector<float>, 3> sampled;
  for (const std::uint32_t v : some_of(counts, kSampled)) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      sampled[static_cast<std::size_t>(axis)].push_back(mesh.positions[v][axis]);
    }
  }
  Eigen::AlignedBox3f box = whole;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<float>& at = sampled[static_cast<std::size_t>(axis)];
    if (at.empty()) {
      continue;
    }
    const auto skip = static_cast<std::size_t>(kStray * static_cast<double>(at.size()));
    const float low = value_at_rank(at, skip);
    const float high = value_at_rank(at, at.size() - 1 - skip);
    const float beyond = kBeyond * (high - low) + 2.0F * static_cast<float>(mean_edge_mm);
    box.min()[axis] = std::max(whole.min()[axis], low - beyond);
    box.max()[axis] = std::min(whole.max()[axis], high + beyond);
  }
  return box;
}

/// The standard deviation where it is noise, from the median over about kSampled vertices.
double roughness(const Mesh& mesh, const VertexGraph& graph, const VertexGeometry& geometry,
                 const std::vector<bool>& counts) {
  constexpr std::size_t kSampled = 100000;
  const std::vector<std::uint32_t> some = some_of(counts, kSampled);
  std::vector<float> away(some.size());
  parallel_for_each_index(away.size(), [&](std::size_t k) {
    const std::uint32_t v = some[k];
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const std::uint32_t w : graph.ring(v)) {
      middle += mesh.positions[w];
    }
    const auto count = static_cast<float>(graph.ring(v).size());
    const float off = std::abs((mesh.positions[v] - middle / count).dot(geometry.normal[v]));
    away[k] = count > 0 && std::isfinite(off) ? off : -1.0F;
  });
  std::erase(away, -1.0F);
  if (away.empty()) {
    return 0;
  }
  return kSigmaOfMedian * median_of(std::move(away));
}

}  // namespace

VertexGeometry make_vertex_geometry(const Mesh& mesh, const VertexGraph& graph) {
  const std::size_t vertices = mesh.positions.size();
  VertexGeometry geometry;
  geometry.normal.resize(vertices);
  geometry.area_mm2.resize(vertices);
  const Sums first = parallel_reduce_ordered(
      vertices, kGrain, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums sums;
        for (std::size_t i = begin; i < end; ++i) {
          const auto v = static_cast<std::uint32_t>(i);
          at_vertex(mesh, graph.faces_at(v), &geometry.normal[i], &geometry.area_mm2[i]);
          sums.area += geometry.area_mm2[i];
          float length = 0;
          for (const std::uint32_t w : graph.ring(v)) {
            length += (mesh.positions[w] - mesh.positions[i]).norm();
          }
          if (std::isfinite(length)) {
            sums.edges += length;
            sums.edge_count += static_cast<double>(graph.ring(v).size());
          }
        }
        return sums;
      },
      [](Sums& into, const Sums& s) { join(into, s); });
  geometry.total_area_mm2 = first.area;
  geometry.mean_edge_mm = first.edge_count > 0 ? first.edges / first.edge_count : 0;
  if (!(first.area > 0)) {
    return geometry;
  }
  geometry.parts = find_parts(graph, geometry.area_mm2);
  const std::vector<bool> counts = of_no_scrap(geometry);
  geometry.box = box_without_strays(mesh, counts, geometry.mean_edge_mm);
  geometry.roughness_mm = roughness(mesh, graph, geometry, counts);
  turn_outward(mesh, &geometry);
  return geometry;
}

}  // namespace dubsar
