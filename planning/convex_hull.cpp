// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/convex_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/parallel.h"
#include "core/sphere_directions.h"
#include "core/units.h"

namespace dubsar {

namespace {

struct HullFace {
  std::array<std::uint32_t, 3> v;
  Eigen::Vector3d normal;  ///< unit
  double offset;
};

class Hull {
 public:
  explicit Hull(std::span<const Eigen::Vector3d> points) : points_(points) {}

  [[nodiscard]] std::vector<HullFace> build() {
    if (!start()) {
      return {};
    }
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      add(i);
    }
    return faces_;
  }

 private:
  void push(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Eigen::Vector3d n = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    const double length = n.norm();
    const Eigen::Vector3d unit = length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
    faces_.push_back({{a, b, c}, unit, unit.dot(points_[a])});
  }

  /// The point of greatest value; the first of equals.
  template <class Value>
  std::uint32_t farthest(const Value& value) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < points_.size(); ++i) {
      best = value(points_[i]) > value(points_[best]) ? i : best;
    }
    return best;
  }

  bool start() {
    if (points_.size() < 4) {
      return false;
    }
    const std::uint32_t a = farthest([](const Eigen::Vector3d& p) { return p.x(); });
    const Eigen::Vector3d pa = points_[a];
    const std::uint32_t b = farthest([&](const Eigen::Vector3d& p) { return (p - pa).squaredNorm(); });
    const double extent = (points_[b] - pa).norm();
    epsilon_ = 1e-9 * extent;
    if (!(extent > 0)) {
      return false;
    }
    const Eigen::Vector3d ab = (points_[b] - pa) / extent;
    const std::uint32_t c = farthest([&](const Eigen::Vector3d& p) { return (p - pa).cross(ab).norm(); });
    const Eigen::Vector3d n = (points_[b] - pa).cross(points_[c] - pa).normalized();
    const std::uint32_t d = farthest([&](const Eigen::Vector3d& p) { return std::abs(n.dot(p - pa)); });
    const double height = n.dot(points_[d] - pa);
    if (!(std::abs(height) > 1e-6 * extent)) {
      return false;
    }
    const std::uint32_t second = height > 0 ? c : b;
    const std::uint32_t third = height > 0 ? b : c;
    push(a, second, third);
    push(a, third, d);
    push(third, second, d);
    push(second, a, d);
    return true;
  }

  void add(std::uint32_t i) {
    std::vector<HullFace> kept;
    std::set<std::pair<std::uint32_t, std::uint32_t>> open;
    for (const HullFace& f : faces_) {
      if (f.normal.dot(points_[i]) - f.offset <= epsilon_) {
        kept.push_back(f);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = f.v[k];
        const std::uint32_t to = f.v[(k + 1) % 3];
        // An edge between two faces that both go is met from both sides.
        if (open.erase({to, from}) == 0) {
          open.insert({from, to});
        }
      }
    }
    if (kept.size() == faces_.size()) {
      return;
    }
    faces_ = std::move(kept);
    for (const auto& [from, to] : open) {
      push(from, to, i);
    }
  }

  std::span<const Eigen::Vector3d> points_;
  std::vector<HullFace> faces_;
  double epsilon_ = 0;
};

}  // namespace

std::vector<Eigen::Vector3d> extreme_points(std::span<const Eigen::Vector3f> points,
                                            std::span<const Eigen::Vector3d> directions) {
  if (points.empty()) {
    return {};
  }
  std::vector<std::size_t> best(directions.size(), 0);
  parallel_for_each_index(
      directions.size(),
      [&](std::size_t k) {
        const Eigen::Vector3f d = directions[k].cast<float>();
        float most = d.dot(points[0]);
        for (std::size_t i = 1; i < points.size(); ++i) {
          const float along = d.dot(points[i]);
          if (along > most) {
            most = along;
            best[k] = i;
          }
        }
      },
      8);
  std::sort(best.begin(), best.end());
  best.erase(std::unique(best.begin(), best.end()), best.end());
  std::vector<Eigen::Vector3d> out;
  out.reserve(best.size());
  for (const std::size_t i : best) {
    out.push_back(points[i].cast<double>());
  }
  return out;
}

std::vector<Eigen::Vector3d> hull_points(std::span<const Eigen::Vector3f> points) {
  std::vector<Eigen::Vector3d> directions = sphere_directions(300);
  std::vector<Eigen::Vector3d> out = extreme_points(points, directions);
  for (const HullFace& f : Hull(out).build()) {
    directions.push_back(f.normal);
  }
  out = extreme_points(points, directions);
  return out;
}

std::vector<Eigen::Vector3f> thinned_for_hull(std::span<const Eigen::Vector3f> points) {
  const std::size_t stride = points.size() / 40000 + 1;
  std::vector<Eigen::Vector3f> thinned;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    thinned.push_back(points[i]);
  }
  return thinned;
}

Mesh convex_hull(std::span<const Eigen::Vector3d> points) {
  Mesh mesh;
  for (const Eigen::Vector3d& p : points) {
    mesh.positions.push_back(p.cast<float>());
  }
  for (const HullFace& f : Hull(points).build()) {
    mesh.faces.push_back(f.v);
  }
  return mesh;
}

}  // namespace dubsar
