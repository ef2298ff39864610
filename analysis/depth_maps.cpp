// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/depth_maps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 16U;
/// With this many mean edges to a pixel the points alone leave no hole in a map.
constexpr double kEdgesPerPixel = 1.6;
/// Up to here most faces are drawn, at two pixels an edge.
constexpr std::size_t kFewFaces = 300000;
/// A face with a longer edge is drawn: it may well span a pixel without having a corner in it. A few missed
/// ones matter where every face counts.
constexpr float kLargePx = 2.0F;
constexpr float kLargeOfFewPx = 1.0F;
/// However coarse a drawn mesh is, its maps are no smaller.
constexpr double kLeastSidePx = 256;
constexpr int kMarginPx = 2;

bool usable(const Mesh& mesh, const std::array<std::uint32_t, 3>& f) {
  return f[0] < mesh.positions.size() && f[1] < mesh.positions.size() && f[2] < mesh.positions.size() &&
         mesh.positions[f[0]].allFinite() && mesh.positions[f[1]].allFinite() &&
         mesh.positions[f[2]].allFinite();
}

float longest_edge(const Mesh& mesh, const std::array<std::uint32_t, 3>& f) {
  const Vector3f& a = mesh.positions[f[0]];
  const Vector3f& b = mesh.positions[f[1]];
  const Vector3f& c = mesh.positions[f[2]];
  return std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
}

}  // namespace

DepthMapPlan plan_depth_maps(const Mesh& mesh, const Eigen::AlignedBox3f& box, double mean_edge_mm,
                             int longest_px) {
  DepthMapPlan plan;
  if (box.isEmpty()) {
    return plan;
  }
  plan.centre_mm = box.center();
  const float reach = std::max(box.diagonal().norm(), 1e-6F);
  const bool few = mesh.faces.size() <= kFewFaces;
  const double wanted = mean_edge_mm * (few ? 0.5 : kEdgesPerPixel);
  const double room = longest_px - 2 * kMarginPx;
  const double coarsest = few ? reach / kLeastSidePx : reach;
  plan.pixel_mm = static_cast<float>(std::max(std::min(wanted, coarsest), reach / room));
  plan.side_px = static_cast<int>(std::ceil(reach / plan.pixel_mm)) + 2 * kMarginPx;
  const float large_px = few ? kLargeOfFewPx : kLargePx;
  const std::size_t faces = mesh.faces.size();
  const std::size_t chunks = (faces + kGrain - 1) / kGrain;
  std::vector<std::vector<std::uint32_t>> large(chunks);
  parallel_chunks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (usable(mesh, mesh.faces[i]) && longest_edge(mesh, mesh.faces[i]) > large_px * plan.pixel_mm) {
        large[begin / kGrain].push_back(static_cast<std::uint32_t>(i));
      }
    }
  });
  for (const auto& part : large) {
    plan.large_faces.insert(plan.large_faces.end(), part.begin(), part.end());
  }
  return plan;
}

DepthMapPair::DepthMapPair(const Mesh& mesh, std::span<const float> area_mm2, const DepthMapPlan& plan,
                           const Vector3f& direction)
    : direction_(direction), side_(plan.side_px) {
  const Vector3f u = direction.unitOrthogonal();
  const Vector3f v = direction.cross(u);
  u_px_ = u / plan.pixel_mm;
  v_px_ = v / plan.pixel_mm;
  const float middle = 0.5F * static_cast<float>(side_);
  offset_u_px_ = middle - plan.centre_mm.dot(u_px_);
  offset_v_px_ = middle - plan.centre_mm.dot(v_px_);
  const std::size_t pixels = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  nearest_ = BigArray<float>(pixels);
  farthest_ = BigArray<float>(pixels);
  std::fill_n(&nearest_[0], pixels, -std::numeric_limits<float>::infinity());
  std::fill_n(&farthest_[0], pixels, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (area_mm2[i] > 0) {
      splat(mesh.positions[i]);
    }
  }
  for (const std::uint32_t i : plan.large_faces) {
    const auto& f = mesh.faces[i];
    draw(mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]);
  }
}

void DepthMapPair::splat(const Vector3f& p_mm) {
  const float x = p_mm.dot(u_px_) + offset_u_px_;
  const float y = p_mm.dot(v_px_) + offset_v_px_;
  const auto side = static_cast<float>(side_);
  if (!(x >= 0 && y >= 0 && x < side && y < side)) {
    return;  // not finite
  }
  const std::size_t pixel = static_cast<std::size_t>(static_cast<int>(y)) * static_cast<std::size_t>(side_) +
                            static_cast<std::size_t>(static_cast<int>(x));
  const float depth = p_mm.dot(direction_);
  nearest_[pixel] = std::max(nearest_[pixel], depth);
  farthest_[pixel] = std::min(farthest_[pixel], depth);
}

void DepthMapPair::draw(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  struct Corner {
    float x, y, depth;
  };
  const auto corner = [&](const Vector3f& p) {
    return Corner{p.dot(u_px_) + offset_u_px_, p.dot(v_px_) + offset_v_px_, p.dot(direction_)};
  };
  const std::array<Corner, 3> k{corner(a), corner(b), corner(c)};
  const float area = (k[1].x - k[0].x) * (k[2].y - k[0].y) - (k[2].x - k[0].x) * (k[1].y - k[0].y);
  if (std::abs(area) < 1e-6F) {
    return;  // edge on: its corners are there
  }
  const auto first = [](float low) { return std::max(0, static_cast<int>(std::ceil(low - 0.5F))); };
  const auto last = [&](float high) {
    return std::min(side_ - 1, static_cast<int>(std::floor(high - 0.5F)));
  };
  const int y0 = first(std::min({k[0].y, k[1].y, k[2].y}));
  const int y1 = last(std::max({k[0].y, k[1].y, k[2].y}));
  const int x0 = first(std::min({k[0].x, k[1].x, k[2].x}));
  const int x1 = last(std::max({k[0].x, k[1].x, k[2].x}));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5F;
      const float py = static_cast<float>(y) + 0.5F;
      const float s = ((px - k[0].x) * (k[2].y - k[0].y) - (k[2].x - k[0].x) * (py - k[0].y)) / area;
      const float t = ((k[1].x - k[0].x) * (py - k[0].y) - (px - k[0].x) * (k[1].y - k[0].y)) / area;
      if (s >= 0 && t >= 0 && s + t <= 1) {
        const float depth = k[0].depth + s * (k[1].depth - k[0].depth) + t * (k[2].depth - k[0].depth);
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
        nearest_[pixel] = std::max(nearest_[pixel], depth);
        farthest_[pixel] = std::min(farthest_[pixel], depth);
      }
    }
  }
}

std::vector<Vector3f> half_sphere_directions(int count) {
  std::vector<Vector3f> directions;
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) / count;
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(static_cast<float>(r * std::cos(golden * i)),
                            static_cast<float>(r * std::sin(golden * i)), static_cast<float>(z));
  }
  return directions;
}

}  // namespace dubsar
