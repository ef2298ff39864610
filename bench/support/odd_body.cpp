// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/odd_body.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace dubsar::bench {

namespace {

using Eigen::Vector3d;

double box_mm(const Vector3d& p, const Vector3d& half) {
  const Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

bool one_in(Random& random, double share) {
  return random.uniform() < share;
}

}  // namespace

OddBody::OddBody(Random& random) {
  shape_ = static_cast<Shape>(random.below(static_cast<std::uint64_t>(Shape::kCount)));
  size_mm_ = random.uniform(2, 6);
  thin_mm_ = std::pow(10.0, random.uniform(-1.3, 0.3));
  wave_mm_ = one_in(random, 0.4) ? 0.0 : std::pow(10.0, random.uniform(-2, 0));
  const double per_mm = std::pow(10.0, random.uniform(-0.5, 1));
  for (Wave& wave : waves_) {
    wave.per_mm = per_mm * random.normal3();
    wave.phase = random.uniform(0, 6.28);
  }
}

double OddBody::outside_mm(const Vector3d& p) const {
  double out = 0;
  switch (shape_) {
    case Shape::kBall:
      out = p.norm() - size_mm_;
      break;
    case Shape::kPlate:
      out = box_mm(p, {size_mm_, 0.8 * size_mm_, 0.5 * thin_mm_});
      break;
    case Shape::kBox:
      out = box_mm(p, {size_mm_, 0.7 * size_mm_, 0.5 * size_mm_});
      break;
    case Shape::kRing:
      out = std::hypot(std::hypot(p.x(), p.y()) - size_mm_, p.z()) - std::max(0.3, thin_mm_);
      break;
    case Shape::kTouching:
      out =
          std::min((p - Vector3d(0.5 * size_mm_, 0, 0)).norm(), (p + Vector3d(0.5 * size_mm_, 0, 0)).norm()) -
          (0.5 * size_mm_ + 0.1 * (thin_mm_ - 0.3));
      break;
    case Shape::kRods:
    default: {
      const double r = std::max(0.2, 0.5 * thin_mm_);
      out = std::min({std::hypot(p.x(), p.y()), std::hypot(p.y(), p.z()), std::hypot(p.z(), p.x())}) - r;
      out = std::max(out, p.norm() - size_mm_);
    }
  }
  if (wave_mm_ > 0) {
    for (const Wave& wave : waves_) {
      out += 0.5 * wave_mm_ * std::sin(wave.per_mm.dot(p) + wave.phase);
    }
  }
  return out;
}

std::string OddBody::name() const {
  constexpr const char* kNames[] = {"ball", "plate", "box", "ring", "touching balls", "rods"};
  char text[96];
  std::snprintf(text, sizeof text, "%s of %.1f mm, %.2f thin, waves %.3f", kNames[static_cast<int>(shape_)],
                size_mm_, thin_mm_, wave_mm_);
  return text;
}

OddScanning::OddScanning(Random& random) {
  spacing_mm_ = random.uniform(0.08, 0.35);
  stretch_ = one_in(random, 0.6) ? 1.0 : random.uniform(0.4, 2.5);
  other_scale_ = one_in(random, 0.7) ? 1.0 : random.uniform(0.3, 3.0);
  noise_mm_ = one_in(random, 0.4) ? 0.0 : std::pow(10.0, random.uniform(-3, -0.7));
  quantum_mm_ = one_in(random, 0.8) ? 0.0 : random.uniform(0.01, 0.2);
  missing_ = one_in(random, 0.7) ? 0.0 : random.uniform(0, 0.5);
  holes_ = one_in(random, 0.7) ? 0.0 : random.uniform(0, 0.4);
  stray_ = one_in(random, 0.7) ? 0.0 : random.uniform(0, 0.1);
  along_axes_ = one_in(random, 0.25);
}

std::pair<RangeGrid, RigidTransform> OddScanning::scan(const OddBody& body, Random& random) const {
  RigidTransform pose;
  if (along_axes_) {
    const auto quarter = [&](const Vector3d& axis) -> Eigen::Matrix3d {
      return Eigen::AngleAxisd(0.5 * kPi * static_cast<double>(random.below(4)), axis).toRotationMatrix();
    };
    const Eigen::Matrix3d first = quarter(Vector3d::UnitX());
    pose.rotation = (quarter(Vector3d::UnitY()) * first).array().round();
  } else {
    pose.rotation = RigidTransform::from_twist(random.normal3() * 2.0, Vector3d::Zero()).rotation;
  }
  RangeGrid grid;
  constexpr int kMost = 120;  // rows, columns
  const double step_mm = spacing_mm_ * (one_in(random, 0.33) ? other_scale_ : 1.0);
  const double row_mm = step_mm * stretch_;
  const double reach_mm = random.uniform(2, 8);
  const double half_mm = std::ceil(reach_mm / step_mm) * step_mm;
  const int cols = std::clamp(static_cast<int>(2 * half_mm / step_mm) + 1, 2, kMost);
  const int rows =
      one_in(random, 0.02) ? 1 : std::clamp(static_cast<int>(2 * half_mm / row_mm) + 1, 2, kMost);
  const int centre_row = rows / 2;
  const int centre_col = cols / 2;
  grid.allocate(rows, cols);
  grid.spacing_mm = std::max(step_mm, row_mm);
  constexpr double kFromMm = 9.0;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      Vector3d p{(col - centre_col) * step_mm, (row - centre_row) * row_mm, kFromMm};
      double outside = 0;
      for (int k = 0; k < 200 && p.z() > -kFromMm; ++k) {
        outside = body.outside_mm(pose * p);
        if (outside < 1e-4) {
          break;
        }
        p.z() -= std::max(1e-4, 0.5 * outside);
      }
      if (outside >= 1e-3 || p.z() <= -kFromMm) {
        continue;
      }
      p.z() += noise_mm_ * random.normal();
      if (one_in(random, stray_)) {
        p.z() += random.uniform(-3, 3);
      }
      if (quantum_mm_ > 0) {
        p.z() = quantum_mm_ * std::round(p.z() / quantum_mm_);
      }
      if (one_in(random, missing_)) {
        continue;
      }
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(p.x());
      grid.y[i] = static_cast<float>(p.y());
      grid.z[i] = static_cast<float>(p.z());
      grid.valid[i] = 1;
    }
  }
  for (int row = 0; row < rows; row += 5) {
    for (int col = 0; col < cols; col += 5) {
      const bool hole = one_in(random, holes_);
      for (int k = 0; k < 25 && hole; ++k) {
        if (grid.inside(row + k / 5, col + k % 5)) {
          grid.valid[grid.index(row + k / 5, col + k % 5)] = 0;
        }
      }
    }
  }
  return {std::move(grid), pose};
}

std::string OddScanning::name() const {
  char text[200];
  std::snprintf(text, sizeof text,
                "%.2f mm, rows %.2f, others %.2f, noise %.3f, steps %.2f, missing %.2f, holes %.2f, stray "
                "%.2f%s",
                spacing_mm_, stretch_, other_scale_, noise_mm_, quantum_mm_, missing_, holes_, stray_,
                along_axes_ ? ", along axes" : "");
  return text;
}

}  // namespace dubsar::bench
