// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/height_surface.h"

#include <algorithm>
#include <cmath>

namespace dubsar {
HeightSurface::HeightSurface(Mesh mesh, const Eigen::Vector3f& origin_mm, float cell_mm,
                             const Eigen::Vector3i& nodes, float band_mm, std::vector<float> distance_mm)
    : mesh_(std::move(mesh)), origin_mm_(origin_mm), cell_mm_(cell_mm), nodes_(nodes), band_mm_(band_mm),
      distance_mm_(std::move(distance_mm)) {}
std::optional<HeightSurface::Cell> HeightSurface::cell_at(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f g = (p - origin_mm_) / cell_mm_;
  Eigen::Vector3i c;
  for (int k = 0; k < 3; ++k) {
    c[k] = static_cast<int>(std::floor(g[k]));
    if (c[k] < 0 || c[k] >= nodes_[k] - 1) return std::nullopt;
  }
  const auto node = (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(nodes_.y()) + static_cast<std::size_t>(c.y())) * static_cast<std::size_t>(nodes_.x()) + static_cast<std::size_t>(c.x());
  return Cell{node, g - c.cast<float>()};
}
float HeightSurface::height_mm(const Eigen::Vector3f& p) const {
  const auto cell = cell_at(p);
  if (!cell) return band_mm_;
  const auto sx = std::size_t{1}, sy = static_cast<std::size_t>(nodes_.x()), sz = sy * static_cast<std::size_t>(nodes_.y());
  float sum = 0;
  for (unsigned c = 0; c < 8; ++c) {
    const float w = ((c & 1U) ? cell->t.x() : 1 - cell->t.x()) * ((c & 2U) ? cell->t.y() : 1 - cell->t.y()) * ((c & 4U) ? cell->t.z() : 1 - cell->t.z());
    sum += w * distance_mm_[cell->node + ((c & 1U) ? sx : 0) + ((c & 2U) ? sy : 0) + ((c & 4U) ? sz : 0)];
  }
  return sum;
}
Eigen::Vector3f HeightSurface::normal(const Eigen::Vector3f& p) const {
  Eigen::Vector3f g;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3f d = Eigen::Vector3f::Zero();
    d[k] = 0.5F * cell_mm_;
    g[k] = height_mm(p + d) - height_mm(p - d);
  }
  return g.norm() > 1e-6F ? g.normalized() : Eigen::Vector3f::Zero();
}
std::optional<Eigen::Vector3f> HeightSurface::closest(const Eigen::Vector3f& p) const {
  Eigen::Vector3f q = p;
  for (int i = 0; i < 5; ++i) q -= height_mm(q) * normal(q);
  return q;
}
std::optional<Eigen::Vector3f> HeightSurface::crossing(const Eigen::Vector3f& p, const Eigen::Vector3f& d, float reach) const {
  float before = height_mm(p);
  float at = 0;
  while (at < reach) {
    const float next = std::min(reach, at + 0.25F * cell_mm_);
    const float h = height_mm(p + next * d);
    if ((h > 0) != (before > 0)) return Eigen::Vector3f(p + (at + (next - at) * before / (before - h)) * d);
    before = h;
    at = next;
  }
  return std::nullopt;
}
}  // namespace dubsar
