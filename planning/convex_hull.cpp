// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/convex_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "core/parallel.h"
#include "core/sphere_directions.h"
#include "core/units.h"

namespace dubsar {

namespace {

using Corner = std::array<std::int64_t, 3>;
/// GCC's and Clang's own, as C++23 names none of that width.
__extension__ typedef __int128 Wide;

/// Coordinates are whole numbers of at most this: the volume of four of them fits into 127 bits.
constexpr double kMostSteps = 274877906944.0;  // 2^38

struct HullFace {
  std::array<std::uint32_t, 3> v;
  std::array<Wide, 3> normal;          ///< out of the hull; twice the area
  std::array<double, 3> rough_normal;  ///< the same, rounded
};

/// On a raster of 2^-38 of the extent (a third of a picometre of 100 mm) it is told exactly which faces a
/// point sees. Sums of doubles do not tell it: samples lie in planes and on lines, and where the face of
/// three that nearly lie on a line is taken to be seen and its neighbours are not, the hull comes apart.
class Hull {
 public:
  explicit Hull(std::span<const Eigen::Vector3d> points) { take(points); }

  [[nodiscard]] std::vector<HullFace> build() {
    if (!start()) {
      return {};
    }
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      add(i);
    }
    return faces_;
  }

 private:
  void take(std::span<const Eigen::Vector3d> points) {
    if (points.empty()) {
      return;
    }
    const Eigen::Vector3d origin = points.front();
    double extent = 0;
    for (const Eigen::Vector3d& p : points) {
      if (!p.allFinite()) {
        return;
      }
      extent = std::max(extent, (p - origin).cwiseAbs().maxCoeff());
    }
    if (!(extent > 0)) {
      return;
    }
    const double steps = kMostSteps / extent;
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d q = steps * (p - origin);
      corners_.push_back({std::llround(q.x()), std::llround(q.y()), std::llround(q.z())});
    }
  }

  static Corner minus(const Corner& a, const Corner& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Wide times(std::int64_t a, std::int64_t b) { return static_cast<Wide>(a) * b; }
  static std::array<Wide, 3> cross(const Corner& a, const Corner& b) {
    return {times(a[1], b[2]) - times(a[2], b[1]), times(a[2], b[0]) - times(a[0], b[2]),
            times(a[0], b[1]) - times(a[1], b[0])};
  }
  static double square(const std::array<Wide, 3>& n) {
    return Eigen::Vector3d(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]))
        .squaredNorm();
  }

  void push(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::array<Wide, 3> n = cross(minus(corners_[b], corners_[a]), minus(corners_[c], corners_[a]));
    faces_.push_back(
        {{a, b, c}, n, {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}});
  }

  /// Above 0: the point sees the face from outside.
  [[nodiscard]] double height(const HullFace& f, std::uint32_t i) const {
    const Corner d = minus(corners_[i], corners_[f.v[0]]);
    double sum = 0;
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double term = f.rough_normal[k] * static_cast<double>(d[k]);
      sum += term;
      size += std::abs(term);
    }
    if (std::abs(sum) > 1e-14 * size) {
      return sum;
    }
    return static_cast<double>(f.normal[0] * d[0] + f.normal[1] * d[1] + f.normal[2] * d[2]);
  }

  /// The point of greatest value; the first of equals.
  template <class Value>
  std::uint32_t farthest(const Value& value) const {
    std::uint32_t best = 0;
    double most = value(0);
    for (std::uint32_t i = 1; i < corners_.size(); ++i) {
      if (const double v = value(i); v > most) {
        most = v;
        best = i;
      }
    }
    return best;
  }

  bool start() {
    if (corners_.size() < 4) {
      return false;
    }
    const auto from = [&](std::uint32_t a, std::uint32_t i) { return minus(corners_[i], corners_[a]); };
    const std::uint32_t a = farthest([&](std::uint32_t i) { return static_cast<double>(corners_[i][0]); });
    const std::uint32_t b = farthest([&](std::uint32_t i) {
      const Corner d = from(a, i);
      return Eigen::Vector3d(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]))
          .squaredNorm();
    });
    const Corner ab = from(a, b);
    const std::uint32_t c = farthest([&](std::uint32_t i) { return square(cross(ab, from(a, i))); });
    push(a, b, c);
    const HullFace base = faces_.back();
    faces_.clear();
    const std::uint32_t d = farthest([&](std::uint32_t i) { return std::abs(height(base, i)); });
    const double above = height(base, d);
    const double area = std::sqrt(square(base.normal));
    // Less than a millionth of its extent high: points in a plane.
    if (!(std::abs(above) > 1e-6 * area * std::sqrt(square({ab[0], ab[1], ab[2]})))) {
      return false;
    }
    const std::uint32_t second = above > 0 ? c : b;
    const std::uint32_t third = above > 0 ? b : c;
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
      if (height(f, i) <= 0) {
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

  std::vector<Corner> corners_;
  std::vector<HullFace> faces_;
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
    directions.push_back(Eigen::Vector3d(f.rough_normal.data()).normalized());
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
