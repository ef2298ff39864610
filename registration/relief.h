// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar {

struct SurfaceLevel;

/// What is written on the body: how far each cell of a level stands above or below the surface around it, the
/// body's own bend taken off. Tablets are nearly symmetric in shape, never in relief: where two scans show
/// the same relief at the same places, they lie right.
struct Relief {
  std::vector<float> height_mm;  ///< [rows*cols] of the level, out of the clay positive; NaN where unknown
  std::vector<std::uint32_t> cells;  ///< those that are known and sent into other scans, evenly spread
  double cell_area_mm2 = 0;          ///< of surface that one entry of `cells` stands for
  double rms_mm = 0;
  double radius_mm = 0;  ///< of the neighbourhood that it is measured against
};

/// Relief of the level's usable cells against their neighbourhood of the given radius; at most `most_cells`
/// are sent.
[[nodiscard]] Relief make_relief(const SurfaceLevel& level, double radius_mm, std::size_t most_cells);

/// How well the relief of two scans agrees under a pose: sums over cells that lie on each other.
struct ReliefAgreement {
  double pairs = 0;
  double area_mm2 = 0;
  double s = 0, t = 0, ss = 0, tt = 0, st = 0;  ///< sums of source and target heights and their products
  double residual = 0;                          ///< sum of the cells' distances from the target's surface

  void add(const ReliefAgreement& b) {
    pairs += b.pairs;
    area_mm2 += b.area_mm2;
    s += b.s;
    t += b.t;
    ss += b.ss;
    tt += b.tt;
    st += b.st;
  }
  /// Pearson's, in [-1, 1]; 0 where there is nothing to compare.
  [[nodiscard]] double correlation() const;
  /// Fisher's z of the correlation in its standard deviations, for as many independent places as the common
  /// area holds: beyond 5 or so chance is out of the question, however many poses were tried.
  [[nodiscard]] double significance(double radius_mm) const;
};

/// Sends the source's relief into the target (both over their levels). A cell counts when it lies within
/// tolerance_mm of the target's surface and the normals agree.
[[nodiscard]] ReliefAgreement relief_agreement(const SurfaceLevel& source, const Relief& source_relief,
                                               const SurfaceLevel& target, const Relief& target_relief,
                                               const RigidTransform& target_from_source, double tolerance_mm);

}  // namespace dubsar
