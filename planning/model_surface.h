// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/mesh_query.h"
#include "core/placed_scan.h"
#include "planning/model_faces.h"

namespace dubsar {

/// A bit of surface, model frame.
struct SurfacePatch {
  Eigen::Vector3d position_mm{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};
  double area_mm2 = 0;
};

struct ModelSurfaceOptions {
  double step_mm = 0.25;           ///< edge length of the occluding surface, at least µ
  std::size_t max_quads = 150000;  ///< larger models get a larger step
  std::size_t patches = 5000;      ///< of the closing surface
};

/// The model so far as planning sees it: a thin surface that casts shadows, and the convex hull, which a
/// tablet nearly is (made whole by symmetry, completion.h), as the estimate of what nobody has seen. A patch
/// of the hull counts as seen when a ray from it into the clay meets the surface from outside; what has no
/// samples yet is met from behind, or not at all. Where it is not met at all and cameras looked through all
/// that the hull spans there, no surface is missing: such a patch is neither seen nor unseen.
struct ModelSurface {
  MeshQuery query;
  Mesh mesh;
  double step_mm = 0;
  Eigen::Vector3d center_mm{0, 0, 0};       ///< of the hull's bounding box along the faces
  std::vector<Eigen::Vector3d> corners_mm;  ///< of the hull
  ModelFaces faces;
  std::vector<SurfacePatch> seen;    ///< of the hull, unit area each about equal
  std::vector<SurfacePatch> unseen;  ///< of the hull
};

/// The non-flagged samples of the scans triangulated, thinned to about step_mm, each place once; model frame.
[[nodiscard]] Mesh thinned_surface(std::span<const PlacedScan> scans, double step_mm);

/// True when rays from the patch into the clay meet the surface from outside. A slit between the triangles of
/// two scans lets some rays through, a hole as wide as the patch nearly all; what is narrower than a patch is
/// told by its red border.
[[nodiscard]] bool seen_from_outside(const MeshQuery& query, const SurfacePatch& patch, double step_mm);

/// model: the stitched mesh where there is one, which then casts the shadows; otherwise the non-flagged
/// samples of the scans are triangulated, thinned, each place once.
[[nodiscard]] ModelSurface model_surface(std::span<const PlacedScan> scans, const Mesh* model = nullptr,
                                         const ModelSurfaceOptions& options = {});

}  // namespace dubsar
