// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar {

struct SurfaceLevel;

/// What is on the body, its shape left aside: how far each cell of a level stands above or below the surface
/// around it, the body's own bend taken off, and how light it is against its surroundings where the grid has
/// intensities. Tablets are nearly symmetric in shape, never in relief: where two scans show the same at the
/// same places, they lie right.
struct Relief {
  std::vector<float> height_mm;  ///< [rows*cols] of the level, out of the clay positive; NaN where unknown
  std::vector<float> tone;  ///< [rows*cols], logarithm of the intensity, likewise; empty when there is none
  /// [rows*cols] of the level: beside a sharp rim, or on one. It stands above its surroundings wherever it
  /// runs, and one rim is like any other: there the height tells of the body's shape too.
  std::vector<std::uint8_t> at_rim;
  std::vector<std::uint32_t> cells;  ///< those of known height that are sent into other scans, evenly spread
  double cell_area_mm2 = 0;          ///< of surface that one entry of `cells` stands for
  double rms_mm = 0;
  double tone_rms = 0;
  double radius_mm = 0;  ///< of the neighbourhood that it is measured against
};

/// Relief of the level's usable cells against their neighbourhood of the given radius; at most `most_cells`
/// are sent. `intensity` is [rows*cols] of the level, NaN where unknown, or empty. What is alike along a
/// whole row or column of the tone is the scanner's, not the clay's, and is taken off.
[[nodiscard]] Relief make_relief(const SurfaceLevel& level, const std::vector<float>& intensity,
                                 double radius_mm, std::size_t most_cells);

/// Sums of pairs of values for Pearson's correlation.
struct Correlation {
  double n = 0, s = 0, t = 0, ss = 0, tt = 0, st = 0;
  void add(double a, double b) {
    n += 1;
    s += a;
    t += b;
    ss += a * a;
    tt += b * b;
    st += a * b;
  }
  void add(const Correlation& o) {
    n += o.n;
    s += o.s;
    t += o.t;
    ss += o.ss;
    tt += o.tt;
    st += o.st;
  }
  /// In [-1, 1]; 0 where there is nothing to compare.
  [[nodiscard]] double value() const;
};

/// How well two scans agree under a pose in what is on the clay, over the cells that lie on each other.
struct ReliefAgreement {
  Correlation height, tone;
  Correlation off_rims;  ///< of height, where neither is at a rim
  double area_mm2 = 0;

  void add(const ReliefAgreement& b) {
    height.add(b.height);
    off_rims.add(b.off_rims);
    tone.add(b.tone);
    area_mm2 += b.area_mm2;
  }
  /// Fisher's z of the correlations in standard deviations, for as many independent places as the common area
  /// holds: beyond 5 or so chance is out of the question, however many poses were tried. Tone adds to height
  /// (as the root of the sum of squares) where it agrees and is left aside where it does not: light falls
  /// differently from one pose to the next.
  [[nodiscard]] double significance(double radius_mm) const;
  /// The same without what lies at rims.
  [[nodiscard]] double significance_off_rims(double radius_mm) const;
  /// The larger of the two.
  [[nodiscard]] double correlation() const;
  /// How many independent places the common area holds.
  [[nodiscard]] double places(double radius_mm) const;

 private:
  /// Of this height and the tone.
  [[nodiscard]] double together(const Correlation& by_height, double radius_mm) const;
};

/// Sends the source's relief into the target (both over their levels). A cell counts when it lies within
/// tolerance_mm of the target's surface and the normals agree.
[[nodiscard]] ReliefAgreement relief_agreement(const SurfaceLevel& source, const Relief& source_relief,
                                               const SurfaceLevel& target, const Relief& target_relief,
                                               const RigidTransform& target_from_source, double tolerance_mm);

}  // namespace dubsar
