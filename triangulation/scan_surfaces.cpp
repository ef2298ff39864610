// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/scan_surfaces.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "triangulation/placed_precision.h"
#include "triangulation/stage_passes.h"

namespace dubsar {

std::string stitched_name(const PlacedScan& scan) {
  return "scan " + std::to_string(scan.id);
}

Status check_stitchable(const PlacedScan& scan) {
  if (scan.grid == nullptr) {
    return bad_input(stitched_name(scan), "no range grid");
  }
  const std::size_t cells = static_cast<std::size_t>(std::max(scan.grid->rows, 0)) *
                            static_cast<std::size_t>(std::max(scan.grid->cols, 0));
  if (scan.grid->size() != cells || scan.grid->valid.size() != cells) {
    return bad_input(stitched_name(scan), "the grid's arrays do not fit its rows and columns");
  }
  if (scan.flags != nullptr && !scan.flags->empty() && scan.flags->size() != cells) {
    return bad_input(stitched_name(scan), "flags and grid have different sizes", "flag the grid again");
  }
  if (!scan.model_from_scanner.is_rigid() || !scan.model_from_scanner.translation_mm.allFinite()) {
    return bad_input(stitched_name(scan), "its pose is not a rigid transform", "register the scan again");
  }
  return PlacedPrecision(*scan.grid).check(scan.model_from_scanner, stitched_name(scan));
}

std::vector<StitchSurface> surfaces_of_passes(const PlacedScan& scan, const StitchSurfaceOptions& options,
                                              const JobContext& job) {
  const RangeGrid& grid = *scan.grid;
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  const std::vector<StagePass> passes =
      spacing_mm > 0 ? stage_passes(grid, spacing_mm) : std::vector<StagePass>{};
  std::vector<StitchSurface> out;
  if (passes.empty() || passes.front().size() == static_cast<std::size_t>(grid.rows)) {
    out.push_back(make_scan_surface(scan, options, job));
    return out;
  }
  for (const StagePass& pass : passes) {
    if (job.cancelled()) {
      break;
    }
    RangeGrid part = grid_of_pass(grid, pass);
    part.spacing_mm = spacing_mm;
    SampleFlags flags;
    for (const int row : pass) {
      const auto first = static_cast<std::ptrdiff_t>(grid.index(row, 0));
      if (scan.flags != nullptr && !scan.flags->empty()) {
        flags.insert(flags.end(), scan.flags->begin() + first, scan.flags->begin() + first + grid.cols);
      }
    }
    PlacedScan placed = scan;
    placed.grid = &part;
    placed.flags = &flags;
    out.push_back(make_scan_surface(placed, options, job));
  }
  return out;
}

}  // namespace dubsar
