// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/tablet_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planning/convex_hull.h"

namespace dubsar {

namespace {

constexpr double kSameDirection = 0.9986;  // cosine of three degrees

/// The 26 directions of a cube's faces, edges and corners and the 24 between its faces and edges; then those
/// of the same box seen as a cushion, whose broad sides bulge.
std::vector<Eigen::Vector3d> plane_directions(const Eigen::Vector3d& half_mm) {
  std::vector<Eigen::Vector3d> directions;
  const auto add = [&](const Eigen::Vector3d& n) {
    const Eigen::Vector3d unit = n.normalized();
    const bool known = std::any_of(directions.begin(), directions.end(),
                                   [&](const Eigen::Vector3d& d) { return d.dot(unit) > kSameDirection; });
    if (!known) {
      directions.push_back(unit);
    }
  };
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const int ones = (std::abs(x) == 1) + (std::abs(y) == 1) + (std::abs(z) == 1);
        const int twos = (std::abs(x) == 2) + (std::abs(y) == 2) + (std::abs(z) == 2);
        if ((twos == 0 && ones > 0) || (twos == 1 && ones == 1)) {
          add(Eigen::Vector3d(x, y, z));
        }
      }
    }
  }
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) {
          add(Eigen::Vector3d(x, y, z).cwiseQuotient(half_mm));
        }
      }
    }
  }
  return directions;
}

}  // namespace

double TabletHull::clearance_mm(const Eigen::Vector3d& p_mm) const {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < normals.size(); ++k) {
    most = std::max(most, normals[k].dot(p_mm) - supports_mm[k]);
  }
  return most;
}

TabletHull hull_of_box(const Eigen::Vector3d& size_mm, double edge_radius_mm) {
  TabletHull hull;
  hull.half_mm = 0.5 * size_mm;
  hull.normals = plane_directions(hull.half_mm);
  const Eigen::Vector3d core = hull.half_mm.array() - edge_radius_mm;
  for (const Eigen::Vector3d& n : hull.normals) {
    hull.supports_mm.push_back(n.cwiseAbs().dot(core) + edge_radius_mm);
  }
  return hull;
}

TabletHull hull_of_mesh(const Mesh& mesh, const RigidTransform& tablet_from_model) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(mesh.positions.size());
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.allFinite()) {
      points.push_back(tablet_from_model * p.cast<double>());
      box.extend(points.back());
    }
  }
  TabletHull hull;
  if (points.empty()) {
    return hull;
  }
  hull.half_mm = 0.5 * box.sizes();
  hull.normals = plane_directions(hull.half_mm.cwiseMax(1e-3));
  for (const Eigen::Vector3d& n : hull.normals) {
    double support = -std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& p : points) {
      support = std::max(support, n.dot(p));
    }
    hull.supports_mm.push_back(support - n.dot(box.center()));
  }
  return hull;
}

Mesh box_mesh(const Eigen::Vector3d& size_mm, double edge_radius_mm) {
  constexpr int kSteps = 5;  // of a rounded edge's quarter turn
  const Eigen::Vector3d core = 0.5 * size_mm.array() - edge_radius_mm;
  std::vector<Eigen::Vector3d> points;
  for (int octant = 0; octant < 8; ++octant) {
    const Eigen::Vector3d sign((octant & 1) != 0 ? 1 : -1, (octant & 2) != 0 ? 1 : -1,
                               (octant & 4) != 0 ? 1 : -1);
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Eigen::Vector3d n = Eigen::Vector3d(i, j, kSteps - i - j).normalized();
        points.emplace_back(sign.cwiseProduct(core + edge_radius_mm * n));
        if (edge_radius_mm <= 0) {
          i = j = kSteps;  // all the same corner
        }
      }
    }
  }
  Mesh mesh = convex_hull(points);
  mesh.normals = {};
  return mesh;
}

}  // namespace dubsar
