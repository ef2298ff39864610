// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/vertex_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace dubsar {
namespace {

constexpr std::size_t kGrain = 1U << 14U;
/// A face whose normal stands this much (cosine) against the sum of all at the vertex is taken to be flipped.
constexpr float kAgainst = -0.3F;
/// Share of the whole area-times-distance that must point inwards before the orientation of an open mesh is
/// doubted (a bowl scanned from above has some); of a closed one the sign of its volume tells.
constexpr double kClearlyInward = -0.5;
constexpr double kInward = -0.01;
/// A mesh whose normals sum up to less than this share of its area is as good as closed.
constexpr double kClosed = 0.03;

Eigen::Vector3f twice_area(const Mesh& mesh, std::uint32_t face) {
  const auto& f = mesh.faces[face];
  const Eigen::Vector3f& a = mesh.positions[f[0]];
  return (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a);
}

struct Sums {
  double area = 0;
  double edges = 0;
  double edge_count = 0;
  Eigen::Vector3d centre{0, 0, 0};   ///< times area
  Eigen::Vector3d normals{0, 0, 0};  ///< times area
  double outward = 0;                ///< of normal · (p − centre) times area
  double spread = 0;                 ///< of |p − centre| times area
};

void join(Sums& into, const Sums& s) {
  into.area += s.area;
  into.edges += s.edges;
  into.edge_count += s.edge_count;
  into.centre += s.centre;
  into.normals += s.normals;
  into.outward += s.outward;
  into.spread += s.spread;
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

Eigen::AlignedBox3f box_without_strays(const Mesh& mesh, const VertexGeometry& geometry) {
  constexpr std::size_t kSampled = 200000;
  constexpr double kStray = 0.001;
  constexpr float kBeyond = 0.05F;
  Eigen::AlignedBox3f whole;
  std::array<std::vector<float>, 3> sampled;
  const std::size_t stride = std::max<std::size_t>(1, mesh.positions.size() / kSampled);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (geometry.area_mm2[v] > 0) {
      whole.extend(mesh.positions[v]);
      for (Eigen::Index axis = 0; v % stride == 0 && axis < 3; ++axis) {
        sampled[static_cast<std::size_t>(axis)].push_back(mesh.positions[v][axis]);
      }
    }
  }
  Eigen::AlignedBox3f box = whole;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<float>& at = sampled[static_cast<std::size_t>(axis)];
    if (at.empty()) {
      continue;
    }
    const auto skip = static_cast<std::ptrdiff_t>(kStray * static_cast<double>(at.size()));
    std::nth_element(at.begin(), at.begin() + skip, at.end());
    const float low = at[static_cast<std::size_t>(skip)];
    std::nth_element(at.begin(), at.end() - 1 - skip, at.end());
    const float high = *(at.end() - 1 - skip);
    const float beyond = kBeyond * (high - low) + 2.0F * static_cast<float>(geometry.mean_edge_mm);
    box.min()[axis] = std::max(whole.min()[axis], low - beyond);
    box.max()[axis] = std::min(whole.max()[axis], high + beyond);
  }
  return box;
}

/// 1.48 times the median, the standard deviation where it is noise, over about kSampled vertices.
double roughness(const Mesh& mesh, const VertexGraph& graph, const VertexGeometry& geometry) {
  constexpr std::size_t kSampled = 100000;
  const std::size_t vertices = graph.vertex_count();
  const std::size_t stride = std::max<std::size_t>(1, vertices / kSampled);
  std::vector<float> away(vertices / stride);
  parallel_for_each_index(away.size(), [&](std::size_t k) {
    const auto v = static_cast<std::uint32_t>(k * stride);
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const std::uint32_t w : graph.ring(v)) {
      middle += mesh.positions[w];
    }
    const auto count = static_cast<float>(graph.ring(v).size());
    const float off = std::abs((mesh.positions[v] - middle / count).dot(geometry.normal[v]));
    away[k] = count > 0 && std::isfinite(off) ? off : 0.0F;
  });
  if (away.empty()) {
    return 0;
  }
  const auto middle = away.begin() + static_cast<std::ptrdiff_t>(away.size() / 2);
  std::nth_element(away.begin(), middle, away.end());
  return 1.48 * *middle;
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
          const double area = geometry.area_mm2[i];
          sums.area += area;
          if (area > 0) {
            sums.centre += area * mesh.positions[i].cast<double>();
          }
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
      join);
  geometry.total_area_mm2 = first.area;
  geometry.mean_edge_mm = first.edge_count > 0 ? first.edges / first.edge_count : 0;
  if (!(first.area > 0)) {
    return geometry;
  }
  geometry.box = box_without_strays(mesh, geometry);
  geometry.roughness_mm = roughness(mesh, graph, geometry);
  const Eigen::Vector3f centre = (first.centre / first.area).cast<float>();
  const Sums second = parallel_reduce_ordered(
      vertices, kGrain, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums sums;
        for (std::size_t i = begin; i < end; ++i) {
          if (geometry.area_mm2[i] > 0) {
            const Eigen::Vector3f away = mesh.positions[i] - centre;
            sums.normals += (geometry.area_mm2[i] * geometry.normal[i]).cast<double>();
            sums.outward += geometry.area_mm2[i] * away.dot(geometry.normal[i]);
            sums.spread += geometry.area_mm2[i] * away.norm();
          }
        }
        return sums;
      },
      join);
  const bool closed = second.normals.norm() < kClosed * first.area;
  geometry.turned = second.outward < (closed ? kInward : kClearlyInward) * second.spread;
  if (geometry.turned) {
    parallel_for_each_index(
        vertices, [&](std::size_t i) { geometry.normal[i] = -geometry.normal[i]; }, kGrain);
  }
  return geometry;
}

}  // namespace dubsar
