// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/opening_plane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// Mean value coordinates of p for the polygon's corners (Floater 2003); they add up to 1.
std::vector<double> mean_value_coordinates(const std::vector<Vector2f>& polygon, const Vector2f& p) {
  const std::size_t n = polygon.size();
  std::vector<double> weights(n);
  double sum = 0;
  const auto half_tangent = [&](std::size_t i, std::size_t j) {
    const Vector2f a = polygon[i] - p;
    const Vector2f b = polygon[j] - p;
    const double lengths = static_cast<double>(a.norm()) * b.norm();
    const double cosine = a.dot(b) / std::max(lengths, 1e-20);
    const double sine = static_cast<double>(a.x() * b.y() - a.y() * b.x()) / std::max(lengths, 1e-20);
    return std::abs(sine) < 1e-12 ? 0.0 : (1.0 - cosine) / sine;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::max<double>((polygon[i] - p).norm(), 1e-9);
    weights[i] = (half_tangent((i + n - 1) % n, i) + half_tangent(i, (i + 1) % n)) / r;
    sum += weights[i];
  }
  for (double& weight : weights) {
    weight = std::abs(sum) < 1e-12 ? 1.0 / static_cast<double>(n) : weight / sum;
  }
  return weights;
}

}  // namespace

float mean_spacing_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening) {
  double sum = 0;
  for (const std::uint32_t v : opening) {
    sum += static_cast<double>(sheet.spacing_mm[v]);
  }
  return opening.empty() ? 0.0F : static_cast<float>(sum / static_cast<double>(opening.size()));
}

std::optional<OpeningPlane> OpeningPlane::of(const Sheet& sheet, const std::vector<std::uint32_t>& opening) {
  OpeningPlane plane;
  plane.spacing_mm_ = mean_spacing_mm(sheet, opening);
  Vector3f centre = Vector3f::Zero();
  Vector3f normal = Vector3f::Zero();
  for (const std::uint32_t v : opening) {
    centre += sheet.positions[v];
    normal += sheet.normals[v];
  }
  if (!(normal.norm() > 0.3F * static_cast<float>(opening.size())) || !(plane.spacing_mm_ > 0)) {
    return std::nullopt;
  }
  plane.centre_ = centre / static_cast<float>(opening.size());
  plane.normal_ = normal.normalized();
  plane.u_ = plane.normal_.unitOrthogonal();
  plane.v_ = plane.normal_.cross(plane.u_);
  constexpr float kLeastCos = 0.2F;  // steeper walls are as steep as this
  plane.low_ = Vector2f::Constant(std::numeric_limits<float>::max());
  plane.high_ = -plane.low_;
  for (const std::uint32_t v : opening) {
    const Vector2f place = plane.place_of(sheet.positions[v]);
    plane.places_.push_back(place);
    plane.heights_.push_back(plane.height_of(sheet.positions[v]));
    const Vector3f& n = sheet.normals[v];
    plane.slopes_.push_back(-Vector2f(n.dot(plane.u_), n.dot(plane.v_)) /
                            std::max(n.dot(plane.normal_), kLeastCos));
    plane.variances_.push_back(sheet.sigma_mm[v] * sheet.sigma_mm[v]);
    plane.low_ = plane.low_.cwiseMin(place);
    plane.high_ = plane.high_.cwiseMax(place);
  }
  return plane;
}

bool OpeningPlane::encloses(const Vector2f& p) const {
  bool inside = false;
  for (std::size_t i = 0, j = places_.size() - 1; i < places_.size(); j = i++) {
    const Vector2f& a = places_[i];
    const Vector2f& b = places_[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

float OpeningPlane::distance2_to_edges(const Vector2f& p) const {
  float nearest2 = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Vector2f& a = places_[i];
    const Vector2f ab = places_[(i + 1) % places_.size()] - a;
    const float t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-20F), 0.0F, 1.0F);
    nearest2 = std::min(nearest2, (a + t * ab - p).squaredNorm());
  }
  return nearest2;
}

float OpeningPlane::distance2_to_vertices(const Vector2f& p) const {
  float nearest2 = std::numeric_limits<float>::max();
  for (const Vector2f& place : places_) {
    nearest2 = std::min(nearest2, (place - p).squaredNorm());
  }
  return nearest2;
}

OpeningPlane::Interpolated OpeningPlane::interpolate(const Vector2f& p) const {
  constexpr double kOfBend = 0.5;
  const std::vector<double> shares = mean_value_coordinates(places_, p);
  double height = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    height += shares[i] * heights_[i];
  }
  double bend2 = 0, noise2 = 0, sum = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double share = std::abs(shares[i]);
    const Vector2f away = p - places_[i];
    const double off = heights_[i] + slopes_[i].dot(away) - height;
    const double steps2 = away.squaredNorm() / (spacing_mm_ * spacing_mm_);
    bend2 += share * (off * off - 0.5 * steps2 * variances_[i]);
    noise2 += share * variances_[i];
    sum += share;
  }
  const double variance = noise2 + kOfBend * kOfBend * std::max(bend2, 0.0);
  return {static_cast<float>(height), static_cast<float>(std::sqrt(variance / std::max(sum, 1e-12)))};
}

}  // namespace dubsar
