// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <vector>

#include "registration/last_judgement.h"
#include "tests/registration/support/height_field.h"

namespace dubsar::testing {

/// Views of one bumpy field, each where it was taken from; coarse, to be made in no time.
inline std::vector<PlacedSurface> field_views(std::size_t count, std::uint64_t seed = 5) {
  const Height height = bumpy(seed);
  FieldScan scan;
  scan.spacing_mm = 0.6;
  ScanSurfaceOptions options;
  std::vector<PlacedSurface> out;
  for (std::size_t k = 0; k < count; ++k) {
    const auto turn = static_cast<double>(k);
    const RigidTransform model_from_scanner = pose_of(8 - 5 * turn, 3 * turn - 6, 7 * turn, {turn, 0, 0});
    scan.seed = seed + k;
    const RangeGrid grid = scan_field(height, model_from_scanner, scan);
    options.scale_mm = options.scale_mm > 0 ? options.scale_mm : surface_scale_mm(grid);
    out.push_back({make_scan_surface(grid, {}, options), model_from_scanner});
  }
  return out;
}

}  // namespace dubsar::testing
