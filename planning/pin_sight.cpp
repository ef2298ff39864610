// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Rays against an intersection of half spaces: Kay and Kajiya, Ray tracing complex scenes, SIGGRAPH 1986. A
// cone of directions of half width m about the ray x = p - λ d moves x by at most λ m: planes that recede by
// λ m contain what any ray of the cone may hit, and stay linear in λ.
#include "planning/pin_sight.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/units.h"

namespace dubsar {

namespace {

struct Interval {
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
};

/// Where on the ray p + λ · sign · direction, λ >= 0, the grown hull may be met; nothing when no ray of the
/// cone meets it.
std::optional<Interval> meets(std::span<const double> slack_mm, std::span<const double> facing, double sign,
                              double margin) {
  Interval in;
  for (std::size_t k = 0; k < facing.size(); ++k) {
    const double rate = sign * facing[k] - margin;
    if (rate > 0) {
      in.high = std::min(in.high, slack_mm[k] / rate);
    } else if (rate < 0) {
      in.low = std::max(in.low, slack_mm[k] / rate);
    } else if (slack_mm[k] < 0) {
      return std::nullopt;
    }
    if (in.low > in.high) {
      return std::nullopt;
    }
  }
  return in;
}

}  // namespace

SightView sight_view(const Eigen::Vector3d& to_laser, double roll_rad, double triangulation_rad) {
  Eigen::Index least = 0;
  to_laser.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d u = to_laser.cross(Eigen::Vector3d::Unit(least)).normalized();
  const Eigen::Vector3d v = to_laser.cross(u);
  const Eigen::Vector3d beside = std::cos(roll_rad) * u + std::sin(roll_rad) * v;
  return {to_laser, std::cos(triangulation_rad) * to_laser + std::sin(triangulation_rad) * beside};
}

Sightline::Sightline(const TabletHull& hull, const Eigen::Vector3d& direction, double margin)
    : direction_(direction), margin_(margin), facing_(hull.normals.size()) {
  for (std::size_t k = 0; k < facing_.size(); ++k) {
    facing_[k] = hull.normals[k].dot(direction);
  }
}

PinBody::PinBody(const TabletHull& hull, const PinPose& pose, const PinShape& shape)
    : planes_(hull.normals.size()) {
  balls_.push_back({pose.tip_mm, shape.tip_radius_mm});
  const double slope = (shape.arm_radius_mm - shape.tip_radius_mm) / shape.arm_length_mm;
  for (double along = 0; along < shape.arm_length_mm;) {
    const double thin = shape.tip_radius_mm + slope * along;
    const double end = std::min(shape.arm_length_mm, along + 2.0 * thin);
    const double thick = std::max(thin, shape.tip_radius_mm + slope * end);
    balls_.push_back({pose.tip_mm + 0.5 * (along + end) * pose.arm, std::hypot(0.5 * (end - along), thick)});
    along = end;
  }
  slack_mm_.reserve(balls_.size() * planes_);
  for (const Ball& ball : balls_) {
    for (std::size_t k = 0; k < planes_; ++k) {
      slack_mm_.push_back(hull.supports_mm[k] - hull.normals[k].dot(ball.center_mm) + ball.radius_mm);
    }
  }
}

bool PinBody::tip_is_free(const Sightline& to) const {
  return !meets({slack_mm_.data(), planes_}, to.facing(), 1.0, to.margin());
}

bool PinBody::shades(const Sightline& from, const Sightline& other) const {
  for (std::size_t b = 0; b < balls_.size(); ++b) {
    const std::span<const double> slack{slack_mm_.data() + b * planes_, planes_};
    const std::optional<Interval> in = meets(slack, from.facing(), -1.0, from.margin());
    if (!in) {
      continue;
    }
    // The shadow lies on the planes that the interval comes near. Height over plane k, grown by the ball and
    // the cone: linear in λ, so that its greatest value is at an end of the interval.
    for (std::size_t k = 0; k < planes_; ++k) {
      if (from.facing()[k] <= -from.margin() || other.facing()[k] <= -other.margin()) {
        continue;  // clay that one of the two never sees
      }
      const double rate = from.margin() - from.facing()[k];
      const double height = 2.0 * balls_[b].radius_mm - slack[k] + rate * (rate > 0 ? in->high : in->low);
      if (height >= 0) {
        return true;
      }
    }
  }
  return false;
}

bool PinBody::tip_is_never_free(const Sightline& to) const {
  return meets({slack_mm_.data(), planes_}, to.facing(), 1.0, -to.margin()).has_value();
}

bool PinBody::always_shades(const Sightline& from, const Sightline& other) const {
  for (std::size_t b = 0; b < balls_.size(); ++b) {
    const std::span<const double> slack{slack_mm_.data() + b * planes_, planes_};
    const std::optional<Interval> in = meets(slack, from.facing(), -1.0, -from.margin());
    if (!in) {
      continue;
    }
    // At in->low every ray of the cone is inside, and the height over a plane that it faces only falls on its
    // way there: what is near the plane there was so where the ray came in.
    for (std::size_t k = 0; k < planes_; ++k) {
      const bool faces = from.facing()[k] > from.margin() && other.facing()[k] > other.margin();
      if (faces && 2.0 * balls_[b].radius_mm - slack[k] - (from.facing()[k] + from.margin()) * in->low >= 0) {
        return true;
      }
    }
  }
  return false;
}

bool PinBody::tip_is_behind(const PinBody& other, const Sightline& to) const {
  for (const Ball& ball : other.balls_) {
    const Eigen::Vector3d way = ball.center_mm - tip().center_mm;
    const double length_squared = way.squaredNorm();
    const double along = way.dot(to.direction());
    const double reach = tip().radius_mm + ball.radius_mm + to.margin() * std::sqrt(length_squared);
    if (along > -reach && length_squared - along * along < reach * reach) {
      return true;
    }
  }
  return false;
}

PinBody::Shield PinBody::shield_of(const PinBody& other, double margin) const {
  const Eigen::Vector3d middle = other.balls_[other.balls_.size() / 2].center_mm;
  Shield shield;
  shield.axis = (middle - tip().center_mm).normalized();
  double widest = 0;
  for (const Ball& ball : other.balls_) {
    const Eigen::Vector3d way = ball.center_mm - tip().center_mm;
    const double length = way.norm();
    const double reach = tip().radius_mm + ball.radius_mm + margin * length;
    if (length <= 1.5 * reach) {
      return {shield.axis, -1.0};
    }
    widest = std::max(
        widest, std::acos(std::clamp(way.dot(shield.axis) / length, -1.0, 1.0)) + std::asin(reach / length));
  }
  shield.least_cosine = widest < kPi ? std::cos(widest) - 1e-9 : -1.0;
  return shield;
}

double PinBody::distance_mm(const PinBody& other) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Ball& a : balls_) {
    for (const Ball& b : other.balls_) {
      least = std::min(least, (a.center_mm - b.center_mm).norm() - a.radius_mm - b.radius_mm);
    }
  }
  return least;
}

bool stands_and_shows(const PinBody& pin, const Sightline& laser, const Sightline& camera) {
  return pin.tip_is_free(laser) && pin.tip_is_free(camera) && !pin.shades(laser, camera) &&
         !pin.shades(camera, laser);
}

bool never_stands_and_shows(const PinBody& pin, const Sightline& laser, const Sightline& camera) {
  return pin.tip_is_never_free(laser) || pin.tip_is_never_free(camera) || pin.always_shades(laser, camera) ||
         pin.always_shades(camera, laser);
}

}  // namespace dubsar
