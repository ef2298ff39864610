// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/side_curve.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

using Eigen::Vector2d;

constexpr double kStepMm = 0.05;
/// Corners of the outline are rounded at this scale, so that an edge unrolls evenly.
constexpr double kSmoothMm = 2.0;
constexpr double kCellMm = 0.5;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Counter-clockwise (Andrew 1979).
std::vector<Vector2d> convex_hull(const std::vector<Eigen::Vector2f>& all) {
  std::vector<Eigen::Vector2f> sorted = all;
  std::erase_if(sorted, [](const Eigen::Vector2f& p) { return !p.allFinite(); });
  std::ranges::sort(
      sorted, [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Vector2d> hull;
  const auto add = [&](const Eigen::Vector2f& point, std::size_t least) {
    const Vector2d p = point.cast<double>();
    while (hull.size() >= least + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const auto& p : sorted) {
    add(p, 0);
  }
  const std::size_t lower = hull.empty() ? 0 : hull.size() - 1;
  for (auto it = sorted.rbegin(); it != sorted.rend(); ++it) {
    add(*it, lower);
  }
  if (!hull.empty()) {
    hull.pop_back();
  }
  return hull;
}

/// A closed line anew with points evenly spaced, about step_mm apart; the true step comes back in it.
std::vector<Vector2d> resampled(const std::vector<Vector2d>& ring, double* step_mm) {
  double length = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
  }
  const auto count = std::max<std::size_t>(16, static_cast<std::size_t>(length / *step_mm));
  *step_mm = length / static_cast<double>(count);
  std::vector<Vector2d> out;
  out.reserve(count);
  double passed = 0;
  for (std::size_t i = 0; i < ring.size() && out.size() < count; ++i) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[(i + 1) % ring.size()];
    const double part = (b - a).norm();
    while (out.size() < count && static_cast<double>(out.size()) * *step_mm <= passed + part) {
      const double t = part > 0 ? (static_cast<double>(out.size()) * *step_mm - passed) / part : 0.0;
      out.push_back(a + t * (b - a));
    }
    passed += part;
  }
  while (out.size() < count) {
    out.push_back(ring.front());
  }
  return out;
}

std::vector<Vector2d> smoothed(const std::vector<Vector2d>& ring, double step_mm) {
  const auto reach = std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(3 * kSmoothMm / step_mm),
                                              static_cast<std::ptrdiff_t>(ring.size()) / 2 - 1);
  std::vector<double> weight;
  double sum = 0;
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const double t = static_cast<double>(k) * step_mm / kSmoothMm;
    weight.push_back(std::exp(-0.5 * t * t));
    sum += weight.back();
  }
  const auto count = static_cast<std::ptrdiff_t>(ring.size());
  std::vector<Vector2d> out(ring.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    Vector2d mean(0, 0);
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
      mean += weight[static_cast<std::size_t>(k + reach)] *
              ring[static_cast<std::size_t>((i + k + count) % count)];
    }
    out[static_cast<std::size_t>(i)] = mean / sum;
  }
  return out;
}

}  // namespace

SideCurve::SideCurve(const std::vector<Eigen::Vector2f>& yz_mm) {
  std::vector<Vector2d> ring = convex_hull(yz_mm);
  if (ring.size() < 3) {
    return;
  }
  // With y to the right and z up, the way down the obverse (z > 0, y falling) and on round the bottom edge is
  // counter-clockwise, as the hull is.
  // Its points keep the steps of the outline: rounding draws a bend inwards, and by the length that is left
  // a seal would be rolled out too short.
  step_mm_ = kStepMm;
  const std::vector<Vector2d> outline = resampled(ring, &step_mm_);
  ring = smoothed(outline, step_mm_);
  const auto normal = [&](std::size_t i) {
    const Vector2d along = ring[(i + 1) % ring.size()] - ring[(i + ring.size() - 1) % ring.size()];
    return Vector2d(along.y(), -along.x()).normalized();
  };
  std::size_t begin = 0;
  const Vector2d between(std::sqrt(0.5), std::sqrt(0.5));
  for (std::size_t i = 1; i < ring.size(); ++i) {
    if (normal(i).dot(between) > normal(begin).dot(between)) {
      begin = i;
    }
  }
  std::ranges::rotate(ring, ring.begin() + static_cast<std::ptrdiff_t>(begin));
  points_ = std::move(ring);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vector2d along = points_[next(i)] - points_[before(i)];
    outward_.push_back(Vector2d(along.y(), -along.x()).normalized());
  }
  make_lookup();
}

void SideCurve::make_lookup() {
  Vector2d low = points_.front();
  Vector2d high = low;
  for (const Vector2d& p : points_) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  constexpr double kMarginMm = 2;
  low_mm_ = low.array() - kMarginMm;
  cells_y_ = static_cast<int>((high.x() + kMarginMm - low_mm_.x()) / kCellMm) + 1;
  cells_z_ = static_cast<int>((high.y() + kMarginMm - low_mm_.y()) / kCellMm) + 1;
  lookup_.resize(static_cast<std::size_t>(cells_y_) * static_cast<std::size_t>(cells_z_));
  constexpr std::size_t kCoarse =
      8;  // points of the curve that are looked at: place() finds the rest of the way
  for (int j = 0; j < cells_z_; ++j) {
    for (int i = 0; i < cells_y_; ++i) {
      const Vector2d middle = low_mm_ + kCellMm * Vector2d(i + 0.5, j + 0.5);
      std::size_t best = 0;
      for (std::size_t k = 0; k < points_.size(); k += kCoarse) {
        if ((points_[k] - middle).squaredNorm() < (points_[best] - middle).squaredNorm()) {
          best = k;
        }
      }
      lookup_[static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_y_) +
              static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(best);
    }
  }
}

SideCurve::Place SideCurve::place(const Vector2d& p) const {
  const Vector2d cell = (p - low_mm_) / kCellMm;
  const auto clamped = [](double value, int count) {
    return static_cast<std::size_t>(std::clamp(value, 0.0, count - 1.0));
  };
  std::size_t at =
      lookup_[clamped(cell.y(), cells_z_) * static_cast<std::size_t>(cells_y_) + clamped(cell.x(), cells_y_)];
  const auto away = [&](std::size_t i) { return (points_[i] - p).squaredNorm(); };
  for (std::size_t steps = 0; steps < points_.size(); ++steps) {
    const std::size_t other = away(next(at)) < away(before(at)) ? next(at) : before(at);
    if (away(other) >= away(at)) {
      break;
    }
    at = other;
  }
  // Between the two points about it, by how far along the tangent the point lies.
  const Vector2d tangent(-outward_[at].y(), outward_[at].x());
  const double along = (p - points_[at]).dot(tangent);
  const std::size_t other = along < 0 ? before(at) : next(at);
  const double apart = (points_[other] - points_[at]).norm();
  const double t = apart > 0 ? std::min(std::abs(along) / apart, 1.0) : 0.0;
  Place place;
  place.outward = ((1 - t) * outward_[at] + t * outward_[other]).normalized();
  place.off_mm = (p - points_[at]).dot(outward_[at]);
  place.along_mm = (static_cast<double>(at) + (along < 0 ? -t : t)) * step_mm_;
  const double length = length_mm();
  place.along_mm += place.along_mm < 0 ? length : 0.0;
  place.along_mm -= place.along_mm >= length ? length : 0.0;
  return place;
}

double SideCurve::along_facing_mm(const Vector2d& direction) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < outward_.size(); ++i) {
    if (outward_[i].dot(direction) > outward_[best].dot(direction)) {
      best = i;
    }
  }
  return static_cast<double>(best) * step_mm_;
}

}  // namespace dubsar
