// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>

#include "core/random.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar::bench {

/// A body of about 10 mm that is no tablet: a ball, a thin plate, a box, a ring, two that touch, three rods,
/// each of them smooth, wavy or rough.
class OddBody {
 public:
  explicit OddBody(Random& random);
  /// Above 0 outside; no farther from the surface than this says, but for its waves.
  [[nodiscard]] double outside_mm(const Eigen::Vector3d& p) const;
  [[nodiscard]] std::string name() const;

 private:
  enum class Shape { kBall, kPlate, kBox, kRing, kTouching, kRods, kCount };
  Shape shape_ = Shape::kBall;
  double size_mm_ = 0;
  double thin_mm_ = 0;
  double wave_mm_ = 0;
  struct Wave {
    Eigen::Vector3d per_mm = Eigen::Vector3d::Zero();
    double phase = 0;
  };
  std::array<Wave, 4> waves_;
};

/// How such a body is scanned, from anywhere, with parallel light: one choice of spacing, noise and damage
/// for all scans of a set.
class OddScanning {
 public:
  explicit OddScanning(Random& random);
  [[nodiscard]] std::pair<RangeGrid, RigidTransform> scan(const OddBody& body, Random& random) const;
  [[nodiscard]] std::string name() const;

 private:
  double spacing_mm_ = 0;
  double stretch_ = 1;      ///< of the rows' distance
  double other_scale_ = 1;  ///< of the spacing of every third scan
  double noise_mm_ = 0;
  double quantum_mm_ = 0;    ///< depths are multiples of this
  double missing_ = 0;       ///< share of the samples
  double holes_ = 0;         ///< share of the squares of 5 × 5 samples
  double stray_ = 0;         ///< share of the samples that lie anywhere within 3 mm
  bool along_axes_ = false;  ///< views along the axes only, on one lattice: samples of several scans coincide
};

}  // namespace dubsar::bench
