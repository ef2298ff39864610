// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

/// A rotation whose z is `up`; x as near to the model's own x as that allows, or to its y.
Eigen::Matrix3d frame_over(const Eigen::Vector3d& up) {
  const Eigen::Vector3d side = std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix3d axes;
  axes.col(2) = up;
  axes.col(0) = (side - side.dot(up) * up).normalized();
  axes.col(1) = up.cross(axes.col(0));
  return axes;
}

double median_edge(const WedgePatch& patch) {
  std::vector<float> lengths;
  for (std::uint32_t v = 0; v < patch.size(); ++v) {
    for (std::uint32_t k = patch.graph.start[v]; k < patch.graph.start[v + 1]; ++k) {
      if (const std::uint32_t n = patch.graph.neighbour[k]; n > v) {
        lengths.push_back((patch.p[v] - patch.p[n]).norm());
      }
    }
  }
  if (lengths.empty()) {
    return 0;
  }
  return median_of(std::move(lengths));
}

void add_triangles(const PatchSource& source, const std::vector<std::int32_t>& slot, WedgePatch* patch) {
  for (const std::uint32_t v : patch->vertex) {
    for (const std::uint32_t f : source.graph->faces_at(v)) {
      const auto& face = source.faces[f];
      const std::int32_t a = slot[face[0]];
      const std::int32_t b = slot[face[1]];
      const std::int32_t c = slot[face[2]];
      // Each triangle once: with the first of its vertices in the patch.
      if (a < 0 || b < 0 || c < 0 || slot[v] != std::min({a, b, c})) {
        continue;
      }
      const auto i = static_cast<std::size_t>(a);
      const auto j = static_cast<std::size_t>(b);
      const auto k = static_cast<std::size_t>(c);
      PatchTriangle t;
      t.n = (patch->p[j] - patch->p[i]).cross(patch->p[k] - patch->p[i]);
      const float twice_area = t.n.norm();
      if (!(twice_area > 0)) {
        continue;
      }
      // A flipped face is one fault more of the mesh, and no other direction of the clay.
      const Eigen::Vector3f outward = patch->n[i] + patch->n[j] + patch->n[k];
      if (source.noisy && outward.norm() > 0.5F) {
        t.n = outward.normalized();
      } else {
        t.n *= (t.n.dot(outward) < 0 ? -1.0F : 1.0F) / twice_area;
      }
      t.vertex = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                  static_cast<std::uint32_t>(c)};
      t.middle = (patch->p[i] + patch->p[j] + patch->p[k]) / 3.0F;
      t.height = (patch->height[i] + patch->height[j] + patch->height[k]) / 3.0F;
      t.weight =
          0.5F * twice_area * fit_weight(std::min({patch->weight[i], patch->weight[j], patch->weight[k]}));
      patch->triangles.push_back(t);
    }
  }
}

}  // namespace

WedgePatch make_patch(const PatchSource& source, std::span<const std::uint32_t> vertices,
                      const Eigen::Vector3d& up, std::vector<std::int32_t>* slot) {
  WedgePatch patch;
  patch.vertex.assign(vertices.begin(), vertices.end());
  patch.inner = vertices.size();
  for (const std::uint32_t v : vertices) {
    (*slot)[v] = 0;
  }
  for (const std::uint32_t v : vertices) {
    for (const std::uint32_t n : source.graph->ring(v)) {
      if ((*slot)[n] < 0) {
        (*slot)[n] = 0;
        patch.vertex.push_back(n);
      }
    }
  }
  const std::size_t count = patch.vertex.size();
  patch.origin = source.position[vertices.front()].cast<double>();
  patch.model_from_patch = frame_over(up);
  patch.depth_mm = -source.height_mm[vertices.front()];
  const Eigen::Matrix3f turn = patch.model_from_patch.transpose().cast<float>();
  patch.p.resize(count);
  patch.n.resize(count);
  patch.weight.resize(count);
  patch.height.resize(count);
  patch.area.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = patch.vertex[i];
    patch.p[i] = turn * (source.position[v] - source.position[vertices.front()]);
    patch.n[i] = turn * source.normal[v];
    patch.weight[i] = source.reliability[v];
    patch.height[i] = source.height_mm[v];
    patch.area[i] = source.area_mm2[v];
    (*slot)[v] = static_cast<std::int32_t>(i);
  }
  patch.graph.start.reserve(count + 1);
  patch.graph.start.push_back(0);
  for (const std::uint32_t v : patch.vertex) {
    for (std::uint32_t k = source.graph->start[v]; k < source.graph->start[v + 1]; ++k) {
      if (const std::int32_t n = (*slot)[source.graph->neighbour[k]]; n >= 0) {
        patch.graph.neighbour.push_back(static_cast<std::uint32_t>(n));
      }
    }
    patch.graph.start.push_back(static_cast<std::uint32_t>(patch.graph.neighbour.size()));
  }
  add_triangles(source, *slot, &patch);
  for (const std::uint32_t v : patch.vertex) {
    (*slot)[v] = -1;
  }
  patch.spacing_mm = median_edge(patch);
  return patch;
}

}  // namespace dubsar
