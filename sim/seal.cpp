// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/seal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"

namespace dubsar::sim {

namespace {

/// An ellipse of a figure, in units of half the band's height.
struct Part {
  double x, y, rx, ry;
};
/// A standing figure with raised arms, a small animal before it, a star above.
constexpr std::array<Part, 9> kParts = {{{0.0, -0.25, 0.17, 0.5},
                                         {0.0, 0.52, 0.13, 0.14},
                                         {0.2, 0.22, 0.22, 0.07},
                                         {-0.2, 0.15, 0.2, 0.07},
                                         {0.0, -0.72, 0.26, 0.1},
                                         {0.85, -0.5, 0.3, 0.16},
                                         {1.15, -0.28, 0.1, 0.13},
                                         {0.72, -0.72, 0.05, 0.14},
                                         {1.0, -0.72, 0.05, 0.14}}};

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

SealBand::SealBand(const TabletBody& body, double relief_mm, std::uint64_t seed) : relief_mm_(relief_mm) {
  Random random(seed_for(seed, 21));
  const Eigen::Vector3d& half = body.half_size_mm();
  half_height_ = std::clamp(0.3 * half.y(), 2.0, 11.0);
  // The end of the reverse, where the text has stopped, is where seals are rolled: towards the top edge.
  middle_y_ = random.uniform(0.25, 0.45) * half.y();
  turn_mm_ = half_height_ * random.uniform(2.4, 3.2);
  shift_mm_ = random.uniform(0.0, turn_mm_);
  tilt_ = random.uniform(-0.05, 0.05);
}

bool SealBand::covers(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const {
  return relief_mm_ > 0 && n.z() < -0.3 && std::abs(p.y() - middle_y_ - tilt_ * p.x()) < half_height_;
}

double SealBand::height_mm(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const {
  if (!covers(p, n)) {
    return 0;
  }
  const double y = -(p.y() - middle_y_ - tilt_ * p.x()) / half_height_;
  const double along = p.x() + shift_mm_;
  const double x = (along - turn_mm_ * std::floor(along / turn_mm_)) / half_height_ - 0.5;
  double relief = 0;
  for (const Part& part : kParts) {
    const double r = std::hypot((x - part.x) / part.rx, (y - part.y) / part.ry);
    relief = std::max(relief, 1.0 - smooth_step(0.55, 1.1, r));
  }
  const double rim = std::abs(y);
  relief = std::max(relief, smooth_step(0.86, 0.9, rim) * (1.0 - smooth_step(0.93, 0.97, rim)));
  // The seal sinks a little into the clay: its ground lies below the free surface.
  return relief_mm_ * (relief - 0.6) * (1.0 - smooth_step(0.97, 1.0, rim)) * smooth_step(-0.3, -0.5, n.z());
}

}  // namespace dubsar::sim
