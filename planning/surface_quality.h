// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/checklist.h"
#include "core/mesh.h"
#include "core/placed_scan.h"
#include "planning/model_faces.h"

namespace dubsar {

struct SurfaceQualityOptions {
  std::size_t places = 60000;  ///< over the measured surface, each for the same area
  /// A sample within this many µ and three standard deviations of the pose is a sample of the place …
  double reach_spacings = 2.0;
  double reach_sigmas = 3.0;
  double most_reach_spacings = 6.0;  ///< … but no farther than this: a bad pose samples nothing well.
};

/// How each face of the measured surface was sampled, and how large it is.
struct SurfaceQuality {
  std::array<SamplingQuality, kFaceCount> faces{};  ///< by Face
  SamplingQuality all;
  std::array<double, kFaceCount> seen_mm2{};
  std::array<double, kFaceCount> interpolated_mm2{};
};

/// Looks at places spread evenly over the faces of the mesh that were measured (without interpolated
/// vertices). A scan samples a place well when its nearest non-sparse sample lies within reach and both its
/// laser and its camera stand before the surface there; its links to the neighbours along row and column,
/// laid into the surface, give the spacing, so that the slope counts. Definitions:
/// docs/scholars/measurements.md, "How well the surface was sampled".
///
/// A triangle belongs to the face that the surface around it looks to (normals averaged over cubes of a
/// twenty-fifth of the model's length), so that the walls of a wedge count with the face that it is written
/// on. scans: registered ones, with their flags; mesh: stitched of them, may be empty. Deterministic for any
/// number of threads.
[[nodiscard]] SurfaceQuality surface_quality(std::span<const PlacedScan> scans, const Mesh& mesh,
                                             const ModelFaces& faces,
                                             const SurfaceQualityOptions& options = {});

}  // namespace dubsar
