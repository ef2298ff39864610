// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid_lookup.h"
#include "core/range_grid.h"
#include "registration/depth_raster.h"
#include "registration/relief.h"

namespace dubsar {

/// One point that takes part in registration, in its scan's own frame.
struct SurfaceSample {
  Eigen::Vector3f position_mm;
  Eigen::Vector3f normal;  ///< unit, out of the surface
  float weight = 1;     ///< mean of 1/d_ik over its neighbours, relative to the scan's mean (seed 001, 3.2)
  bool crease = false;  ///< on a crease edge or beside one
  float row = 0;        ///< of the scan's rows, in [0, 1): when it was scanned …
  float col = 0;        ///< … and of its columns
};

/// A scan at one resolution. Cells of the decimated grid average the samples of a block that lie on one
/// sheet.
struct SurfaceLevel {
  RangeGrid grid;  ///< geometry; of the finest level intensity, too, where the scan has it
  std::vector<Eigen::Vector3f>
      normals;  ///< [rows*cols], smoothed over the 3×3 neighbours of the same sheet; zero if none
  /// [rows*cols], 1 where a sample may be matched: it has a normal and lies neither on the boundary nor
  /// beside a depth step, where the spot's centroid shifts with the camera.
  std::vector<std::uint8_t> usable;
  std::vector<SurfaceSample> samples;  ///< the points that registration sends into other scans
  std::unique_ptr<GridLookup> lookup;  ///< over the usable samples
  DepthRaster raster;  ///< over all valid samples: what this scan's camera saw, and in front of what
  double spacing_mm = 0;
};

struct ScanSurfaceOptions {
  /// Length that the coarse levels and descriptors are scaled by (about the size of the object); 0: this
  /// scan's own.
  double scale_mm = 0;
  std::size_t most_fine_samples = 300000;  ///< the finest level is decimated until it has no more than this
  int fine_points = 8000;                  ///< how many samples each level sends
  int medium_points = 2500;
  int coarse_points = 500;
  double medium_spacing = 0.01;   ///< of scale_mm
  double coarse_spacing = 0.025;  ///< of scale_mm
  double relief_radius = 0.04;    ///< of scale_mm
  int relief_points = 2500;
  double crease_angle_rad =
      0.35;  ///< a normal that turns by more than this to a neighbour marks a crease edge
  double most_crease_share = 0.6;  ///< of the samples that a level sends; the rest are spread evenly
};

/// What registration keeps of a scan: three resolutions with normals, lookups and the samples to be matched.
/// Immutable; the full grid is not referred to.
struct ScanSurface {
  std::unique_ptr<SurfaceLevel> fine, medium, coarse;
  Relief relief;                         ///< of the medium level
  Eigen::Vector3d centroid_mm{0, 0, 0};  ///< of the usable samples, scanner frame
  Eigen::Vector3d toward_camera{0, 0, 1};
  double spacing_mm = 0;  ///< µ of the full grid
  double noise_mm = 0;    ///< of one full-resolution sample along the view, from second differences
  double extent_mm = 0;   ///< root mean square distance of the samples from the centroid, times two
  double scale_mm = 0;    ///< that the levels were made for
  std::size_t valid = 0;  ///< samples of the full grid that were entered
};

/// Length to scale by: the square root of the area that the scan saw, mm. 0 for an empty grid.
[[nodiscard]] double surface_scale_mm(const RangeGrid& grid);

/// Samples with ignore[i] != 0 (pins, arms) are left out when `ignore` is not empty. Non-finite samples count
/// as no return. Spacing is estimated where the grid does not know it. An empty grid gives levels without
/// samples.
[[nodiscard]] std::shared_ptr<const ScanSurface> make_scan_surface(const RangeGrid& grid,
                                                                   const std::vector<std::uint8_t>& ignore,
                                                                   const ScanSurfaceOptions& options);

/// The same scan for another scale_mm, made of what its finest level keeps.
[[nodiscard]] std::shared_ptr<const ScanSurface> rescaled(const ScanSurface& surface,
                                                          const ScanSurfaceOptions& options);

/// The same scan with nothing matched where left_out is not 0 ([cells of the fine grid]) or beside it: what
/// is left out still hides what lies behind it.
[[nodiscard]] std::shared_ptr<const ScanSurface> without(const ScanSurface& surface,
                                                         const std::vector<std::uint8_t>& left_out,
                                                         const ScanSurfaceOptions& options);

/// Sets centroid and extent from the usable samples of the medium level.
void measure_middle(ScanSurface& surface);

}  // namespace dubsar
