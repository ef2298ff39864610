// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/height_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;

float mix(float a, float b, float t) {
  return a + t * (b - a);
}

}  // namespace

HeightSurface::HeightSurface(Mesh mesh, const NodeGrid& grid, float below_mm, float above_mm,
                             std::vector<float> distance_mm)
    : mesh_(std::move(mesh)),
      grid_(grid),
      band_mm_(below_mm),
      above_mm_(above_mm),
      distance_mm_(std::move(distance_mm)) {}

void HeightSurface::shift(const std::function<float(const Vector3f& p_mm)>& outward_mm) {
  parallel_for_each_index(
      static_cast<std::size_t>(grid_.nz),
      [&](std::size_t z) {
        for (int y = 0; y < grid_.ny; ++y) {
          for (int x = 0; x < grid_.nx; ++x) {
            float& d = distance_mm_[grid_.index(x, y, static_cast<int>(z))];
            // Clamped ones stay: there is no slope to be had there anyway.
            if (d > -band_mm_ && d < above_mm_) {
              d -= outward_mm(grid_.node_mm(x, y, static_cast<int>(z)));
            }
          }
        }
      },
      1);
  // Between the nodes heights are straight lines, which cut a curved surface short: the triangles follow
  // them.
  parallel_for_each_index(mesh_.positions.size(), [&](std::size_t i) {
    const Vector3f moved = mesh_.positions[i] + outward_mm(mesh_.positions[i]) * mesh_.normals[i];
    mesh_.positions[i] = closest(moved).value_or(moved);
  });
}

std::optional<HeightSurface::Cell> HeightSurface::cell_at(const Vector3f& p_mm) const {
  const Vector3f at = grid_.place(p_mm);
  const Vector3f top(static_cast<float>(grid_.nx - 1), static_cast<float>(grid_.ny - 1),
                     static_cast<float>(grid_.nz - 1));
  if (distance_mm_.empty() || !((at.array() >= 0).all() && (at.array() < top.array()).all())) {
    return std::nullopt;
  }
  const Vector3f low = at.array().floor();
  return Cell{grid_.index(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z())),
              at - low};
}

std::array<float, 8> HeightSurface::corners(const Cell& cell) const {
  const float* const d = distance_mm_.data() + cell.node;
  const std::size_t row = grid_.row();
  const std::size_t plane = grid_.plane();
  return {d[0], d[1], d[row], d[row + 1], d[plane], d[plane + 1], d[plane + row], d[plane + row + 1]};
}

float HeightSurface::height_mm(const Vector3f& p_mm) const {
  const std::optional<Cell> cell = cell_at(p_mm);
  if (!cell) {
    return above_mm_;
  }
  const std::array<float, 8> c = corners(*cell);
  const Vector3f& t = cell->t;
  return mix(mix(mix(c[0], c[1], t.x()), mix(c[2], c[3], t.x()), t.y()),
             mix(mix(c[4], c[5], t.x()), mix(c[6], c[7], t.x()), t.y()), t.z());
}

Vector3f HeightSurface::normal(const Vector3f& p_mm) const {
  if (!cell_at(p_mm)) {
    return Vector3f::Zero();
  }
  // Over a cell: within one the trilinear slope jumps from cell to cell.
  const float half = 0.5F * grid_.cell_mm;
  Vector3f gradient;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Vector3f on = p_mm;
    Vector3f back = p_mm;
    on[axis] += half;
    back[axis] -= half;
    gradient[axis] = height_mm(on) - height_mm(back);
  }
  const float length = gradient.norm();
  // Where all around is clamped there is no slope.
  return length > 0.1F * grid_.cell_mm ? Vector3f(gradient / length) : Vector3f::Zero();
}

std::optional<Vector3f> HeightSurface::closest(const Vector3f& p_mm) const {
  constexpr int kSteps = 8;
  Vector3f p = p_mm;
  for (int i = 0; i < kSteps; ++i) {
    const float height = height_mm(p);
    const Vector3f n = normal(p);
    if (n.isZero()) {
      return std::nullopt;
    }
    p -= height * n;
    if (std::abs(height) < 1e-4F * grid_.cell_mm) {
      break;
    }
  }
  return p;
}

std::optional<Vector3f> HeightSurface::crossing(const Vector3f& p_mm, const Vector3f& direction,
                                                float reach_mm) const {
  // Distances change no faster than one walks: steps as long as the distance itself pass nothing over.
  const float least = 0.25F * grid_.cell_mm;
  float from = 0;
  float height_from = height_mm(p_mm);
  while (from < reach_mm) {
    const float to = std::min(reach_mm, from + std::max(least, 0.8F * std::abs(height_from)));
    const float height_to = height_mm(p_mm + to * direction);
    if ((height_from < 0) != (height_to < 0)) {
      float low = from;
      float high = to;
      for (int i = 0; i < 24; ++i) {
        const float middle = 0.5F * (low + high);
        ((height_mm(p_mm + middle * direction) < 0) == (height_from < 0) ? low : high) = middle;
      }
      return p_mm + 0.5F * (low + high) * direction;
    }
    from = to;
    height_from = height_to;
  }
  return std::nullopt;
}

}  // namespace dubsar
