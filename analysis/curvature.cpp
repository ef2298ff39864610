// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/curvature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 13U;
/// A face is a sliver when its height is below this share of its longest edge.
constexpr float kSliver = 1e-3F;

struct AtVertex {
  Vector3f laplacian{0, 0, 0};  ///< Σ (cot α + cot β)(x − x_j)
  float area_mm2 = 0;           ///< mixed
  float angles_rad = 0;
  bool sliver = false;
};

/// What the face adds at its corner x, whose next corners are a and b.
void add_face(const Vector3f& x, const Vector3f& a, const Vector3f& b, AtVertex* sum) {
  const Vector3f xa = a - x;
  const Vector3f xb = b - x;
  const Vector3f ab = b - a;
  const float twice_area = xa.cross(xb).norm();
  const float xa2 = xa.squaredNorm();
  const float xb2 = xb.squaredNorm();
  const float ab2 = ab.squaredNorm();
  if (!(twice_area > kSliver * std::max({xa2, xb2, ab2}))) {
    sum->sliver = true;
    return;
  }
  const float dot_x = xa.dot(xb);
  const float dot_a = -xa.dot(ab);
  const float dot_b = xb.dot(ab);
  const float cot_a = dot_a / twice_area;
  const float cot_b = dot_b / twice_area;
  sum->laplacian -= cot_b * xa + cot_a * xb;
  sum->angles_rad += std::atan2(twice_area, dot_x);
  // Voronoi where no angle is obtuse, else a half or a quarter of the face (Meyer et al., Fig. 4).
  if (dot_x < 0) {
    sum->area_mm2 += 0.25F * twice_area;
  } else if (dot_a < 0 || dot_b < 0) {
    sum->area_mm2 += 0.125F * twice_area;
  } else {
    sum->area_mm2 += 0.125F * (cot_b * xa2 + cot_a * xb2);
  }
}

AtVertex gather(const Mesh& mesh, const VertexGraph& graph, std::uint32_t v) {
  AtVertex sum;
  for (const std::uint32_t face : graph.faces_at(v)) {
    const auto& f = mesh.faces[face];
    const std::size_t k = f[0] == v ? 0 : f[1] == v ? 1 : 2;
    add_face(mesh.positions[v], mesh.positions[f[(k + 1) % 3]], mesh.positions[f[(k + 2) % 3]], &sum);
  }
  return sum;
}

}  // namespace

Curvature vertex_curvature(const Mesh& mesh, const VertexGraph& graph, const VertexGeometry& geometry) {
  const std::size_t vertices = graph.vertex_count();
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  Curvature curvature;
  curvature.mean_per_mm.resize(vertices);
  curvature.gaussian_per_mm2.resize(vertices);
  parallel_for_each_index(
      vertices,
      [&](std::size_t i) {
        const auto v = static_cast<std::uint32_t>(i);
        const AtVertex sum = gather(mesh, graph, v);
        const bool any = sum.area_mm2 > 0;
        // K = Σ / (2 A) = 2 H n; along the normal, so that an open border's pull within the surface is out.
        curvature.mean_per_mm[i] =
            any ? sum.laplacian.dot(geometry.normal[i]) / (4.0F * sum.area_mm2) : kNone;
        const bool closed = graph.ring(v).size() == graph.faces_at(v).size() && !sum.sliver;
        curvature.gaussian_per_mm2[i] =
            any && closed ? static_cast<float>(2.0 * kPi - sum.angles_rad) / sum.area_mm2 : kNone;
      },
      kGrain);
  const auto fill = [&](std::vector<float>& values) {
    std::vector<std::pair<std::uint32_t, float>> filled;
    for (std::size_t i = 0; i < vertices; ++i) {
      if (std::isfinite(values[i])) {
        continue;
      }
      float sum = 0;
      float count = 0;
      for (const std::uint32_t w : graph.ring(static_cast<std::uint32_t>(i))) {
        if (std::isfinite(values[w])) {
          sum += values[w];
          count += 1;
        }
      }
      filled.emplace_back(static_cast<std::uint32_t>(i), count > 0 ? sum / count : 0.0F);
    }
    for (const auto& [v, value] : filled) {
      values[v] = value;
    }
  };
  fill(curvature.mean_per_mm);
  fill(curvature.gaussian_per_mm2);
  return curvature;
}

PrincipalCurvature principal_curvature(const Mesh& mesh, const VertexGraph& graph,
                                       const VertexGeometry& geometry, const Curvature& curvature,
                                       std::uint32_t vertex) {
  const float mean = curvature.mean_per_mm[vertex];
  const float apart = std::sqrt(std::max(0.0F, mean * mean - curvature.gaussian_per_mm2[vertex]));
  PrincipalCurvature principal{mean + apart, mean - apart, Vector3f::Zero(), Vector3f::Zero()};
  const Vector3f& n = geometry.normal[vertex];
  if (n.isZero()) {
    return principal;
  }
  const Vector3f u = n.unitOrthogonal();
  const Vector3f w = n.cross(u);
  // B = [[H + a, b], [b, H − a]]: least squares for a, b over the edges, each by the mean of the angles' part
  // that Meyer et al. give it, here its length's.
  Eigen::Matrix2f normal_matrix = Eigen::Matrix2f::Zero();
  Eigen::Vector2f right = Eigen::Vector2f::Zero();
  for (const std::uint32_t j : graph.ring(vertex)) {
    const Vector3f edge = mesh.positions[vertex] - mesh.positions[j];
    const float along_u = edge.dot(u);
    const float along_w = edge.dot(w);
    const float flat = along_u * along_u + along_w * along_w;
    if (!(flat > 0)) {
      continue;
    }
    const float bend = 2.0F * edge.dot(n) / edge.squaredNorm();
    const Eigen::Vector2f row((along_u * along_u - along_w * along_w) / flat, 2 * along_u * along_w / flat);
    const float weight = std::sqrt(flat);
    normal_matrix += weight * row * row.transpose();
    right += weight * (bend - mean) * row;
  }
  // Four edges in a cross say nothing of b: the least of what they allow.
  normal_matrix += 1e-4F * normal_matrix.trace() * Eigen::Matrix2f::Identity();
  if (!(normal_matrix.determinant() > 0)) {
    return principal;
  }
  const Eigen::Vector2f ab = normal_matrix.inverse() * right;
  if (!(ab.norm() > 1e-4F * (std::abs(mean) + apart) + 1e-9F)) {
    return principal;
  }
  const float angle = 0.5F * std::atan2(ab.y(), ab.x());
  principal.maximum_direction = std::cos(angle) * u + std::sin(angle) * w;
  principal.minimum_direction = n.cross(principal.maximum_direction);
  return principal;
}

}  // namespace dubsar
