// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A surface of which a part is not matched.
#include <limits>
#include <utility>

#include "core/dilated.h"
#include "registration/scan_surface.h"
#include "registration/surface_samples.h"

namespace dubsar {

namespace {

/// [cells of the level], 1 on those that a marked cell of the fine level lies in, and on those beside them:
/// their normals and means are mixed.
std::vector<std::uint8_t> marked(const SurfaceLevel& level, const SurfaceLevel& fine,
                                 const std::vector<std::uint8_t>& marks) {
  const double levels_per_fine = fine.spacing_mm / level.spacing_mm;
  const auto place = [&](int cell, int size) {
    return std::min(size - 1, static_cast<int>((cell + 0.5) * levels_per_fine));
  };
  std::vector<std::uint8_t> out(level.grid.size(), 0);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] != 0) {
      out[level.grid.index(place(fine.grid.row_of(i), level.grid.rows),
                           place(fine.grid.col_of(i), level.grid.cols))] = 1;
    }
  }
  return dilated(out, level.grid.rows, level.grid.cols, 1);
}

std::unique_ptr<SurfaceLevel> level_without(const SurfaceLevel& level, const SurfaceLevel& fine,
                                            const std::vector<std::uint8_t>& marks, int points,
                                            const ScanSurfaceOptions& options) {
  auto out = std::make_unique<SurfaceLevel>();
  out->grid = level.grid;
  out->normals = level.normals;
  out->usable = level.usable;
  const std::vector<std::uint8_t> off = marked(level, fine, marks);
  for (std::size_t i = 0; i < off.size(); ++i) {
    out->usable[i] = off[i] != 0 ? 0 : out->usable[i];
  }
  out->raster = level.raster;
  out->spacing_mm = level.spacing_mm;
  out->lookup = std::make_unique<GridLookup>(out->grid, out->usable);
  choose_samples(*out, points, options);
  return out;
}

}  // namespace

std::shared_ptr<const ScanSurface> without(const ScanSurface& surface,
                                           const std::vector<std::uint8_t>& left_out,
                                           const ScanSurfaceOptions& options) {
  auto out = std::make_shared<ScanSurface>();
  const SurfaceLevel& fine = *surface.fine;
  out->fine = level_without(fine, fine, left_out, options.fine_points, options);
  out->medium = level_without(*surface.medium, fine, left_out, options.medium_points, options);
  out->coarse = level_without(*surface.coarse, fine, left_out, options.coarse_points, options);
  out->relief = make_relief(*out->medium, {}, surface.relief.radius_mm,
                            static_cast<std::size_t>(options.relief_points));
  out->relief.tone = surface.relief.tone;
  out->relief.tone_rms = surface.relief.tone_rms;
  for (std::size_t i = 0; i < out->relief.tone.size(); ++i) {
    if (out->medium->usable[i] == 0) {
      out->relief.tone[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  out->toward_camera = surface.toward_camera;
  out->spacing_mm = surface.spacing_mm;
  out->noise_mm = surface.noise_mm;
  out->scale_mm = surface.scale_mm;
  out->valid = surface.valid;
  measure_middle(*out);
  return out;
}

}  // namespace dubsar
