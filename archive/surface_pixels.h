// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "archive/raster.h"

namespace dubsar {

/// What colour the surface has before it is lit.
enum class RenderStyle {
  kClay,         ///< one clay tone
  kRedMap,       ///< pale clay, interpolated vertices amber; what is red is painted as points
  kReliability,  ///< Mesh::reliability on a ramp of lightness, 0 dark to 1 pale
  kScanCount,    ///< Mesh::scans on the same ramp, 1 dark to 6 and more pale
  kColours,      ///< Mesh::colours as they are
  kTone,         ///< grey, one value a vertex: 0 black to 1 white
};

/// The surface as the pixels of a picture see it, subpixels averaged. Structure of arrays, row major.
struct SurfacePixels {
  int width = 0;
  int height = 0;
  std::vector<float> coverage;    ///< share of the pixel that is covered, 0 to 1
  std::vector<float> z_mm;        ///< towards the viewer; kFarAway where nothing is covered
  std::vector<float> nx, ny, nz;  ///< normal in the camera's frame, not normalised; nz > 0
  std::vector<float> r, g, b;     ///< colour of the surface, linear
  std::vector<float> plain;       ///< share that is painted flat rather than lit: points, and the inside

  [[nodiscard]] std::size_t size() const { return coverage.size(); }
};

inline constexpr float kFarAway = -1e9F;

/// Averages the subpixels of each pixel. A style for which the mesh has no values falls back to clay; `tone`
/// [V] is that of kTone. The inside of the surface, seen through a hole, is painted dark.
[[nodiscard]] SurfacePixels resolve(const VisibilityBuffer& buffer, const RenderScene& scene,
                                    const ViewCamera& camera, RenderStyle style, int supersampling,
                                    std::span<const float> tone = {});

}  // namespace dubsar
