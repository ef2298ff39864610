// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "archive/render_scene.h"

namespace dubsar {

/// Where a picture lies in its camera's frame. Pixel (i, j) has its centre at
/// u = left_mm + (i + 0.5) · mm_per_px, v = top_mm − (j + 0.5) · mm_per_px.
struct Framing {
  int width_px = 0;
  int height_px = 0;
  double left_mm = 0;
  double top_mm = 0;
  double middle_mm = 0;  ///< depth that counts as 0, so that depths stay small numbers
  double mm_per_px = 1;
};

inline constexpr std::uint32_t kNothing = 0xffffffffU;
inline constexpr std::uint32_t kPointBit = 0x80000000U;

/// A vertex on the picture, in 1/256 of a subpixel, and its height towards the viewer.
struct ProjectedVertex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  float z_mm = 0;
};
inline constexpr int kFixedBits = 8;

/// What each subpixel sees: a face of the scene, a point (kPointBit | index), or kNothing.
struct VisibilityBuffer {
  int width = 0;  ///< subpixels: the picture's width times the supersampling
  int height = 0;
  std::vector<std::uint32_t> id;          ///< [height * width]
  std::vector<float> z_mm;                ///< [height * width] towards the viewer; undefined at kNothing
  std::vector<ProjectedVertex> vertices;  ///< [V]
};

/// Draws faces and points with a depth buffer on `supersampling`² subpixels per pixel. Coordinates are fixed
/// point with a top-left rule, so that neighbouring faces neither overlap nor leave a crack; equal depths go
/// to the lower index. Bands of rows are drawn in parallel; the result does not depend on the number of
/// threads.
[[nodiscard]] VisibilityBuffer rasterise(const RenderScene& scene, const ViewCamera& camera,
                                         const Framing& framing, int supersampling);

}  // namespace dubsar
