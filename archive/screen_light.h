// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "archive/surface_pixels.h"

namespace dubsar {

/// Light that reaches each pixel, 0 to 1, from what the picture itself knows of the depth: seed 001, Fig. 10
/// ("depth-shading": deeper recesses receive less light) and its shadows. One pass per direction and step
/// over whole rows, so that the compiler can vectorise them.

/// Share of the sky above the surface's own tangent plane that the surroundings within radius_mm leave open
/// (horizon-based occlusion, Bavoil et al. 2008).
[[nodiscard]] std::vector<float> sky_visibility(const SurfacePixels& pixels, double mm_per_px,
                                                double radius_mm);

/// Share of a small lamp in direction (x right, y up, z to the viewer) that is not hidden by anything within
/// reach_mm: shadows with a soft edge.
[[nodiscard]] std::vector<float> lamp_visibility(const SurfacePixels& pixels, double mm_per_px,
                                                 double reach_mm, const Eigen::Vector3d& towards_lamp);

/// How the surface bends, squashed to (-1, 1): positive on ridges, negative in valleys; from the differences
/// of normals between neighbouring pixels (radiance scaling, Vergne et al. 2010). A bend of 1/scale_mm reads
/// tanh(1).
[[nodiscard]] std::vector<float> bending(const SurfacePixels& pixels, double mm_per_px, double scale_mm);

/// The same at a scale of its own: the mean of the bend within radius_mm, from the normals on a ring of that
/// radius, so that the noise of single samples averages out.
[[nodiscard]] std::vector<float> bending_within(const SurfacePixels& pixels, double mm_per_px,
                                                double scale_mm, double radius_mm);

}  // namespace dubsar
