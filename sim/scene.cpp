// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scene.h"

#include <algorithm>
#include <cmath>

namespace dubsar::sim {

namespace {

constexpr double kPinAlbedo = 0.7;

/// Where the segment crosses the support's plane from above, as a share of the way; nothing when it does not.
std::optional<double> crosses(const Support& support, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double above_a = support.normal.dot(a) - support.offset_mm;
  const double above_b = support.normal.dot(b) - support.offset_mm;
  if ((above_a < 0) == (above_b < 0)) {
    return std::nullopt;
  }
  return above_a / (above_a - above_b);
}

/// Smaller root of a t² + 2 b t + c = 0, then the larger.
std::optional<std::pair<double, double>> roots(double a, double b, double c) {
  const double disc = b * b - a * c;
  if (disc < 0 || std::abs(a) < 1e-14) {
    return std::nullopt;
  }
  const double root = std::sqrt(disc);
  const double t0 = (-b - root) / a;
  const double t1 = (-b + root) / a;
  return std::pair{std::min(t0, t1), std::max(t0, t1)};
}

}  // namespace

std::optional<PinHit> hit_pin(const Pin& pin, const Eigen::Vector3d& origin_mm,
                              const Eigen::Vector3d& direction, double near_mm, double far_mm) {
  const Eigen::Vector3d from_tip = origin_mm - pin.tip_mm;
  // Most rays pass far by: the whole pin lies in a ball about its middle.
  const Eigen::Vector3d from_middle = from_tip - 0.5 * pin.arm_length_mm * pin.arm;
  const double bound = 0.5 * pin.arm_length_mm + pin.arm_radius_mm + pin.tip_radius_mm;
  const double along = -from_middle.dot(direction);
  if (from_middle.squaredNorm() - along * along > bound * bound) {
    return std::nullopt;
  }
  std::optional<PinHit> best;
  const auto offer = [&](double t, const Eigen::Vector3d& normal) {
    if (t >= near_mm && t <= far_mm && (!best || t < best->distance_mm)) {
      best = PinHit{t, normal.dot(direction) < 0 ? normal : Eigen::Vector3d(-normal)};
    }
  };
  if (const auto t = roots(1.0, from_tip.dot(direction),
                           from_tip.squaredNorm() - pin.tip_radius_mm * pin.tip_radius_mm)) {
    for (const double root : {t->first, t->second}) {
      offer(root, (from_tip + root * direction) / pin.tip_radius_mm);
    }
  }
  // The cone: distance from the axis = tip radius + slope · height, height in [0, length].
  const double slope = (pin.arm_radius_mm - pin.tip_radius_mm) / pin.arm_length_mm;
  const double d_axis = direction.dot(pin.arm);
  const double o_axis = from_tip.dot(pin.arm);
  const double radius = pin.tip_radius_mm + slope * o_axis;
  const double a = 1.0 - d_axis * d_axis - slope * slope * d_axis * d_axis;
  const double b = from_tip.dot(direction) - o_axis * d_axis - slope * d_axis * radius;
  const double c = from_tip.squaredNorm() - o_axis * o_axis - radius * radius;
  if (const auto t = roots(a, b, c)) {
    for (const double root : {t->first, t->second}) {
      const double height = o_axis + root * d_axis;
      if (height >= 0 && height <= pin.arm_length_mm) {
        const Eigen::Vector3d radial = from_tip + root * direction - height * pin.arm;
        offer(root, (radial.normalized() - slope * pin.arm).normalized());
      }
    }
  }
  return best;
}

std::optional<SceneHit> first_hit(const Scene& scene, const Eigen::Vector3d& origin_mm,
                                  const Eigen::Vector3d& direction, double far_mm) {
  std::optional<SceneHit> best;
  if (const auto hit = scene.query->first_hit(origin_mm.cast<float>(), direction.cast<float>(), 0.0F,
                                              static_cast<float>(far_mm))) {
    const auto& face = scene.tablet->mesh.faces[hit->face];
    const std::vector<float>& albedo = scene.tablet->albedo;
    best = SceneHit{
        hit->distance_mm, hit->normal.cast<double>(),
        (1.0F - hit->u - hit->v) * albedo[face[0]] + hit->u * albedo[face[1]] + hit->v * albedo[face[2]],
        false};
  }
  for (const Pin& pin : scene.pins) {
    const double far_here = best ? best->distance_mm : far_mm;
    if (const auto hit = hit_pin(pin, origin_mm, direction, 0.0, far_here)) {
      best = SceneHit{hit->distance_mm, hit->normal, kPinAlbedo, true};
    }
  }
  if (scene.support) {
    const double far_here = best ? best->distance_mm : far_mm;
    if (const auto share = crosses(*scene.support, origin_mm, origin_mm + far_here * direction)) {
      best = SceneHit{*share * far_here, scene.support->normal, 0.0, false};
    }
  }
  return best;
}

bool blocked(const Scene& scene, const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm, double margin_mm) {
  if (scene.support && crosses(*scene.support, a_mm, b_mm)) {
    return true;
  }
  if (scene.query->occluded(a_mm.cast<float>(), b_mm.cast<float>(), static_cast<float>(margin_mm))) {
    return true;
  }
  const Eigen::Vector3d ab = b_mm - a_mm;
  const double length = ab.norm();
  return std::ranges::any_of(scene.pins, [&](const Pin& pin) {
    return hit_pin(pin, a_mm, ab / length, margin_mm, length - margin_mm).has_value();
  });
}

}  // namespace dubsar::sim
