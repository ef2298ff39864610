// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

/// |x|^p with its derivative.
double power(double x, double p, double* derivative) {
  const double a = std::abs(x);
  const double lower = std::pow(a, p - 1.0);
  *derivative = x < 0 ? -p * lower : p * lower;
  return lower * a;
}

}  // namespace

TabletBody::TabletBody(const Eigen::Vector3d& size_mm, double unevenness_mm, std::uint64_t seed)
    : half_(0.5 * size_mm) {
  Random random(seed_for(seed, 1));
  p_ = random.uniform(4.2, 5.4);
  q_ = random.uniform(2.25, 2.6);
  if (unevenness_mm <= 0) {
    return;
  }
  wave_count_ = static_cast<int>(waves_.size());
  const double extent = half_.head<2>().maxCoeff();
  // On the faces the gradient is q/c per mm: this turns millimetres into levels of the function.
  const double level = unevenness_mm * q_ / half_.z();
  for (Wave& wave : waves_) {
    const Eigen::Vector3d drawn = random.normal3();
    const Eigen::Vector3d direction = Eigen::Vector3d(drawn.x(), drawn.y(), 0.5 * drawn.z()).normalized();
    wave.k = direction * (kPi / (extent * random.uniform(0.5, 1.6)));
    wave.phase = random.uniform(0.0, 2.0 * kPi);
    wave.strength = level * random.uniform(0.2, 0.5);
  }
}

TabletBody TabletBody::even() const {
  TabletBody body = *this;
  body.wave_count_ = 0;
  return body;
}

double TabletBody::value(const Eigen::Vector3d& p_mm, Eigen::Vector3d* gradient) const {
  double dx = 0;
  double dy = 0;
  double dz = 0;
  double sum = power(p_mm.x() / half_.x(), p_, &dx) + power(p_mm.y() / half_.y(), p_, &dy) +
               power(p_mm.z() / half_.z(), q_, &dz) - 1.0;
  *gradient = Eigen::Vector3d(dx / half_.x(), dy / half_.y(), dz / half_.z());
  for (int i = 0; i < wave_count_; ++i) {
    const Wave& wave = waves_[static_cast<std::size_t>(i)];
    const double angle = wave.k.dot(p_mm) + wave.phase;
    sum -= wave.strength * std::cos(angle);
    *gradient += wave.strength * std::sin(angle) * wave.k;
  }
  return sum;
}

Eigen::Vector3d TabletBody::project(const Eigen::Vector3d& p_mm) const {
  Eigen::Vector3d p = p_mm;
  Eigen::Vector3d gradient;
  for (int i = 0; i < 20; ++i) {
    const double f = value(p, &gradient);
    const double slope2 = gradient.squaredNorm();
    if (slope2 < 1e-18) {
      break;
    }
    // A step never longer than 2 mm: where the function is flat Newton would leap out of the body.
    Eigen::Vector3d step = gradient * (f / slope2);
    const double length = step.norm();
    if (length > 2.0) {
      step *= 2.0 / length;
    }
    p -= step;
    if (length < 1e-9) {
      break;
    }
  }
  return p;
}

Eigen::Vector3d TabletBody::radial(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  Eigen::Vector3d gradient;
  double low = 0;
  double high = 2.0 * half_.norm();
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (value(d * middle, &gradient) < 0 ? low : high) = middle;
  }
  return d * (0.5 * (low + high));
}

Eigen::Vector3d TabletBody::normal(const Eigen::Vector3d& p_mm) const {
  Eigen::Vector3d gradient;
  static_cast<void>(value(p_mm, &gradient));
  return gradient.normalized();
}

double TabletBody::depth_below(const Eigen::Vector3d& p_mm) const {
  Eigen::Vector3d foot = project(p_mm);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d n = normal(foot);
    const Eigen::Vector3d next = project(p_mm + n * n.dot(foot - p_mm));
    const double moved = (next - foot).norm();
    foot = next;
    if (moved < 1e-8) {
      break;
    }
  }
  return (foot - p_mm).norm();
}

SurfaceFrame TabletBody::frame_at(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& right) const {
  SurfaceFrame frame;
  frame.p_mm = project(p_mm);
  frame.n = normal(frame.p_mm);
  frame.u = (right - frame.n * frame.n.dot(right)).normalized();
  frame.v = frame.n.cross(frame.u);
  return frame;
}

SurfaceFrame TabletBody::walk(const SurfaceFrame& from, double du_mm, double dv_mm) const {
  const double length = std::hypot(du_mm, dv_mm);
  if (length < 1e-12) {
    return from;
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(length / 0.5)));
  SurfaceFrame at = from;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector3d step = (at.u * du_mm + at.v * dv_mm) / steps;
    // The frame keeps its angle to the way gone: directions are carried along, not turned.
    at = frame_at(at.p_mm + step, at.u);
  }
  return at;
}

SurfaceFrame TabletBody::walk_line(const SurfaceFrame& from, const SurfaceFrame& line, double du_mm) const {
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(du_mm) / 0.5)));
  SurfaceFrame at = from;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector3d ahead = at.p_mm + at.u * (du_mm / steps);
    const double off = line.v.dot(ahead - line.p_mm);
    at = frame_at(ahead - off * at.v, line.v.cross(at.n));
    at = frame_at(at.p_mm, line.v.cross(at.n));
  }
  return at;
}

}  // namespace dubsar::sim
