// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/point_pairs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "registration/absolute_orientation.h"

namespace dubsar {

namespace {

/// Points nearer than this are one place for a hand that clicks.
constexpr double kOnePlaceMm = 2.0;
/// Standard deviation across the line that points must have: with less, clicks say nothing of the turn about
/// it.
constexpr double kLeastWidthMm = 1.0;

std::vector<Eigen::Vector3d> side(std::span<const PointPair> pairs, Eigen::Vector3d PointPair::*which) {
  std::vector<Eigen::Vector3d> points;
  for (const PointPair& pair : pairs) {
    points.push_back(pair.*which);
  }
  return points;
}

/// Standard deviation of points along the second of their principal axes.
double width_mm(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    spread += (p - mean) * (p - mean).transpose() / static_cast<double>(points.size());
  }
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[1]));
}

std::optional<RigidTransform> fitted(std::span<const PointPair> pairs) {
  return absolute_orientation(side(pairs, &PointPair::point_mm), side(pairs, &PointPair::on_point_mm));
}

double worst_miss_mm(std::span<const PointPair> pairs, const RigidTransform& on_from_scanner) {
  double worst = 0;
  for (const PointPair& pair : pairs) {
    worst = std::max(worst, (on_from_scanner * pair.point_mm - pair.on_point_mm).norm());
  }
  return worst;
}

std::string mm_text(double mm) {
  return std::to_string(std::lround(mm)) + " mm";
}

/// The pair without which the others agree best, with its distance from where they put it; nothing when they
/// still disagree.
std::optional<std::pair<std::size_t, double>> odd_one_out(std::span<const PointPair> pairs) {
  std::optional<std::pair<std::size_t, double>> odd;
  double least = kMostClickMissMm;
  for (std::size_t k = 0; k < pairs.size() && pairs.size() > 3; ++k) {
    std::vector<PointPair> others(pairs.begin(), pairs.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const std::optional<RigidTransform> pose = fitted(others);
    const double miss = pose ? worst_miss_mm(others, *pose) : std::numeric_limits<double>::infinity();
    if (miss <= least) {
      least = miss;
      odd.emplace(k, (*pose * pairs[k].point_mm - pairs[k].on_point_mm).norm());
    }
  }
  return odd;
}

}  // namespace

Status check_point_pairs(std::span<const PointPair> pairs, const std::string& where) {
  if (pairs.empty()) {
    return bad_input(where, "there is no point pair in it", "click at least one place in both scans");
  }
  for (std::size_t a = 0; a < pairs.size(); ++a) {
    if (!pairs[a].point_mm.allFinite() || !pairs[a].on_point_mm.allFinite()) {
      return bad_input(where, "point pair " + std::to_string(a + 1) + " is not finite", "click it again");
    }
    for (std::size_t b = 0; b < a; ++b) {
      const double here = (pairs[a].point_mm - pairs[b].point_mm).norm();
      const double there = (pairs[a].on_point_mm - pairs[b].on_point_mm).norm();
      if (std::min(here, there) < kOnePlaceMm) {
        return bad_input(
            where,
            "point pairs " + std::to_string(b + 1) + " and " + std::to_string(a + 1) + " are one place",
            "click places that lie well apart");
      }
      if (pairs.size() == 2 && std::abs(here - there) > kMostClickMissMm) {
        return bad_input(where,
                         "the two points lie " + mm_text(here) + " apart in one scan and " + mm_text(there) +
                             " in the other",
                         "click the same two places in both");
      }
    }
  }
  if (pairs.size() < 3) {
    return {};
  }
  if (std::min(width_mm(side(pairs, &PointPair::point_mm)), width_mm(side(pairs, &PointPair::on_point_mm))) <
      kLeastWidthMm) {
    return bad_input(where, "the points lie on one line", "click a third place beside the line");
  }
  const std::optional<RigidTransform> pose = fitted(pairs);
  if (!pose) {
    return bad_input(where, "the points do not settle a pose", "click three places that lie well apart");
  }
  const double miss = worst_miss_mm(pairs, *pose);
  if (miss > kMostClickMissMm) {
    if (const auto odd = odd_one_out(pairs)) {
      return bad_input(where,
                       "point pair " + std::to_string(odd->first + 1) + " lies " + mm_text(odd->second) +
                           " from where the others put it",
                       "click it again");
    }
    return bad_input(where, "the points are not the same places: they miss each other by " + mm_text(miss),
                     "click them again, in the same order in both scans");
  }
  return {};
}

Result<RigidTransform> solve_point_pairs(std::span<const PointPair> pairs, const std::string& where) {
  if (const Status good = check_point_pairs(pairs, where); !good) {
    return std::unexpected(good.error());
  }
  const std::optional<RigidTransform> pose = pairs.size() < 3 ? std::nullopt : fitted(pairs);
  if (!pose) {
    return bad_input(where, "fewer than three point pairs settle no pose",
                     "click three places in both scans");
  }
  return *pose;
}

bool agrees_with(const PoseHint& hint, const RigidTransform& on_from_scanner,
                 const Eigen::Vector3d& center_mm) {
  if (hint.on_from_scanner) {
    const RigidTransform off = on_from_scanner * hint.on_from_scanner->inverse();
    return off.angle_rad() <= kMostRoughTurnRad &&
           (on_from_scanner * center_mm - *hint.on_from_scanner * center_mm).norm() <= kMostRoughShiftMm;
  }
  return worst_miss_mm(hint.points, on_from_scanner) <= kMostClickMissMm;
}

}  // namespace dubsar
