// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/plane_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::size_t kMost = 20000;  // points that are looked at
constexpr double kStray = 0.0015;     // of them, at each end
constexpr double kEdge = 0.05;        // of a width, at each end
constexpr std::size_t kTurns = 90;    // by a degree, which hides 0.02 % of a side

}  // namespace

PlaneOutline::PlaneOutline(const Plane& plane, const std::vector<Eigen::Vector3d>& points_mm) {
  const Eigen::Vector3d across = plane.normal.unitOrthogonal();
  const Eigen::Vector3d along = plane.normal.cross(across);
  const std::size_t stride = std::max<std::size_t>(1, points_mm.size() / kMost);
  for (std::size_t turn = 0; turn < 2 * kTurns && !points_mm.empty(); ++turn) {
    const double angle = rad_from_deg(static_cast<double>(turn));
    const Eigen::Vector3d direction = std::cos(angle) * across + std::sin(angle) * along;
    std::vector<double> at;
    for (std::size_t i = 0; i < points_mm.size(); i += stride) {
      at.push_back(direction.dot(points_mm[i]));
    }
    const auto stray = static_cast<std::size_t>(kStray * static_cast<double>(at.size()));
    const double low = value_at_rank(at, stray);
    widths_.push_back({direction, low, value_at_rank(at, at.size() - 1 - stray)});
  }
}

std::array<double, 2> PlaneOutline::sides_mm() const {
  std::array<double, 2> best{1e150, 1e150};
  for (std::size_t turn = kTurns; turn < widths_.size(); ++turn) {
    const double width = widths_[turn].mm();
    const double other = widths_[turn - kTurns].mm();
    if (width * other < best[0] * best[1]) {
      best = {std::max(width, other), std::min(width, other)};
    }
  }
  return best;
}

bool PlaneOutline::inside(const Eigen::Vector3d& point_mm) const {
  return !widths_.empty() && std::all_of(widths_.begin(), widths_.end(), [&](const Width& width) {
    const double at = width.direction.dot(point_mm);
    return at >= width.low_mm + kEdge * width.mm() && at <= width.high_mm - kEdge * width.mm();
  });
}

}  // namespace dubsar
