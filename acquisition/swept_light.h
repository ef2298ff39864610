// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/triangulate.h"

namespace dubsar {

/// A stripe and where the stage was when it was seen.
struct SweptRow {
  std::int64_t row = 0;
  std::int64_t timestamp_ns = 0;
  double position = 0;  ///< mm or radians, as RigMotion has it
  StripeProfile stripe;
};

/// Where the middle of the laser's sheet passed a point, seen from several rows of a scan together. In one
/// picture the light of a sheet that is not infinitely thin falls on several heights and several shades at
/// once, and the middle of what is seen is not the middle of the sheet: at the edges and in the depths of
/// wedges by tenths of a pixel. On a line of sight that goes with the clay, though, nothing changes but the
/// light as the sheet sweeps by, whatever the clay's shape and shade (B. Curless, M. Levoy, Better optical
/// triangulation through spacetime analysis, ICCV 1995). Speckle does not go with the clay: the noisier the
/// stripe, the less is corrected, down to nothing.
class SweptLight {
 public:
  /// `sigma_px` of the stripe in the picture, as StripeOptions has it.
  SweptLight(const Triangulator& triangulator, double sigma_px);

  /// Rows on either side that have a say when they are `step` apart (mm or radians); 0 where they are too far
  /// apart to tell anything.
  [[nodiscard]] int reach(double step) const;
  /// Moves the points of rows[middle], as triangulated alone, along their lines of sight. All stripes with
  /// their light; in the order of their positions. Points whose neighbours tell nothing stay.
  void correct(std::span<const SweptRow* const> rows, std::size_t middle, TriangulatedProfile& out) const;

 private:
  /// A neighbour as the middle row's camera has it.
  struct Neighbour {
    const StripeLight* light = nullptr;
    Plane sheet;
    double moved = 0;  ///< of the stage
  };
  [[nodiscard]] double light_at(const StripeLight& light, const Eigen::Vector2d& pixel) const;
  /// Distance between two sheets in the middle of the volume, mm.
  [[nodiscard]] double sheet_step_mm(double from, double to) const;

  const Triangulator& triangulator_;
  double sigma_px_;
  double sigma_mm_ = 0;  ///< of the light across the sheet, blur included
};

}  // namespace dubsar
