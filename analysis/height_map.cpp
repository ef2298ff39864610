// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/height_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 13U;
constexpr std::size_t kFillGrain = 1U << 20U;

/// The larger of two is the same in whatever order they come.
void raise(float& to, float value) {
  std::atomic_ref at(to);
  float now = at.load(std::memory_order_relaxed);
  while (now < value && !at.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

HeightMap::HeightMap(const Mesh& mesh, std::span<const std::uint32_t> faces, const Vector3f& direction,
                     float pixel_mm, int margin_px)
    : direction_(direction), pixel_mm_(pixel_mm), margin_(static_cast<float>(margin_px)) {
  const Vector3f u = direction.unitOrthogonal();
  u_px_ = u / pixel_mm;
  v_px_ = direction.cross(u) / pixel_mm;
  using Box = Eigen::AlignedBox2f;
  const Box box = parallel_reduce_ordered(
      faces.size(), kGrain, Box(),
      [&](std::size_t begin, std::size_t end) {
        Box part;
        for (std::size_t i = begin; i < end; ++i) {
          for (const std::uint32_t v : mesh.faces[faces[i]]) {
            part.extend(Eigen::Vector2f(mesh.positions[v].dot(u_px_), mesh.positions[v].dot(v_px_)));
          }
        }
        return part;
      },
      [](Box& into, const Box& part) { into.extend(part); });
  if (box.isEmpty()) {
    return;
  }
  offset_u_px_ = margin_ - std::floor(box.min().x());
  offset_v_px_ = margin_ - std::floor(box.min().y());
  width_ = static_cast<int>(std::ceil(box.sizes().x())) + 2 * margin_px + 2;
  height_ = static_cast<int>(std::ceil(box.sizes().y())) + 2 * margin_px + 2;
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  heights_ = BigArray<float>(pixels);
  parallel_chunks(pixels, kFillGrain, [&](std::size_t begin, std::size_t end) {
    std::fill_n(&heights_[begin], end - begin, -std::numeric_limits<float>::infinity());
  });
  parallel_for_each_index(
      faces.size(),
      [&](std::size_t i) {
        const auto& f = mesh.faces[faces[i]];
        draw(mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]);
      },
      kGrain);
}

void HeightMap::draw(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const std::array<Vector3f, 3> k{place(a), place(b), place(c)};
  const Vector3f ab = k[1] - k[0];
  const Vector3f ac = k[2] - k[0];
  const float area = ab.x() * ac.y() - ac.x() * ab.y();
  const int y0 = static_cast<int>(std::ceil(std::min({k[0].y(), k[1].y(), k[2].y()})));
  const int y1 = static_cast<int>(std::floor(std::max({k[0].y(), k[1].y(), k[2].y()})));
  const int x0 = static_cast<int>(std::ceil(std::min({k[0].x(), k[1].x(), k[2].x()})));
  const int x1 = static_cast<int>(std::floor(std::max({k[0].x(), k[1].x(), k[2].x()})));
  if (x1 < x0 || y1 < y0 || std::abs(area) < 1e-9F) {
    return;  // between the middles of the pixels, or edge on
  }
  // A rounding of the edges' own size, so that no pixel falls between two faces.
  constexpr float kSlack = -1e-4F;
  const float per_area = 1.0F / area;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) - k[0].x();
      const float py = static_cast<float>(y) - k[0].y();
      const float s = (px * ac.y() - ac.x() * py) * per_area;
      const float t = (ab.x() * py - px * ab.y()) * per_area;
      if (s >= kSlack && t >= kSlack && s + t <= 1 - kSlack) {
        raise(heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(x)],
              k[0].z() + s * ab.z() + t * ac.z());
      }
    }
  }
}

}  // namespace dubsar
