// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planning/pin_search.h"

namespace dubsar {

namespace {

/// A place on the rim before it bends, and which ways out of it there are.
struct RimPlace {
  Eigen::Vector3d core_mm;
  std::vector<Eigen::Vector3d> ways;
};

/// Ways out of a corner, all three ways outwards: seen from most sides, such pins show beside the tablet.
constexpr double kCornerWays[][3] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2},
                                     {2, 2, 1}, {2, 1, 2}, {1, 2, 2}};

/// Stations along a side from its middle to just before the corner, in parts of its half length, both ways.
std::vector<double> stations(double half_mm) {
  constexpr double kStepMm = 6.0;
  const int steps = std::clamp(static_cast<int>(std::lround(half_mm / kStepMm)), 2, 5);
  std::vector<double> at;
  for (int i = -steps + 1; i < steps; ++i) {
    at.push_back(static_cast<double>(i) / steps);
  }
  return at;
}

/// Where p + t · way has the clearance; the hull is convex, so the last such t is the first plane's.
Eigen::Vector3d at_clearance(const TabletHull& hull, const Eigen::Vector3d& p_mm, const Eigen::Vector3d& way,
                             double clearance_mm) {
  double t = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < hull.normals.size(); ++k) {
    const double rate = hull.normals[k].dot(way);
    if (rate > 1e-6) {
      t = std::min(t, (clearance_mm + hull.supports_mm[k] - hull.normals[k].dot(p_mm)) / rate);
    }
  }
  return p_mm + t * way;
}

std::vector<RimPlace> rim_places(const Eigen::Vector3d& core) {
  // Heights: the two edges, and the side between them where it is thick enough for other heights to matter.
  std::vector<RimPlace> places;
  const auto add = [&](const Eigen::Vector3d& at, const Eigen::Vector3d& level, double height) {
    RimPlace place{{at.x(), at.y(), height * core.z()}, {}};
    if (std::abs(height) == 1.0 && level.x() != 0 && level.y() != 0) {
      for (const auto& way : kCornerWays) {
        place.ways.push_back(
            Eigen::Vector3d(way[0] * level.x(), way[1] * level.y(), way[2] * height).normalized());
      }
    } else if (std::abs(height) == 1.0) {
      for (const double lean : {0.5, 1.0, 2.0}) {
        place.ways.push_back(Eigen::Vector3d(level.x(), level.y(), lean * height).normalized());
      }
    }
    place.ways.push_back(level.normalized());
    places.push_back(std::move(place));
  };
  std::vector<double> heights{-1.0, 1.0};
  for (const double h : stations(core.z())) {
    heights.push_back(h);
  }
  for (const double h : heights) {
    for (const double sx : {-1.0, 1.0}) {
      for (const double sy : {-1.0, 1.0}) {
        add({sx * core.x(), sy * core.y(), 0}, Eigen::Vector3d(sx, sy, 0), h);
      }
      for (const double s : stations(core.y())) {
        add({sx * core.x(), s * core.y(), 0}, Eigen::Vector3d(sx, 0, 0), h);
      }
      for (const double s : stations(core.x())) {
        add({s * core.x(), sx * core.y(), 0}, Eigen::Vector3d(0, sx, 0), h);
      }
    }
  }
  return places;
}

}  // namespace

std::vector<PlannedPin> rim_candidates(const TabletHull& hull, double rim_radius_mm,
                                       const PinLayoutOptions& options) {
  const Eigen::Vector3d core = (hull.half_mm.array() - rim_radius_mm).cwiseMax(1e-3 * hull.half_mm.array());
  std::vector<PlannedPin> candidates;
  for (const RimPlace& place : rim_places(core)) {
    for (const Eigen::Vector3d& way : place.ways) {
      PlannedPin pin;
      pin.rim_mm = at_clearance(hull, place.core_mm, way, 0.0);
      Eigen::Vector3d level(way.x(), way.y(), 0);
      std::vector<Eigen::Vector3d> arms{way};
      if (std::abs(way.z()) > 1e-9) {
        level.normalize();
        arms.push_back(level);
        arms.push_back((level + way).normalized());
      }
      for (const double gap : {options.shape.gap_mm, options.shape.most_gap_mm}) {
        pin.pose.tip_mm = at_clearance(hull, place.core_mm, way, gap + options.shape.tip_radius_mm);
        for (const Eigen::Vector3d& arm : arms) {
          pin.pose.arm = arm;
          candidates.push_back(pin);
        }
        if (!(options.shape.most_gap_mm > options.shape.gap_mm)) {
          break;
        }
      }
    }
  }
  return candidates;
}

}  // namespace dubsar
