// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "core/mesh.h"
#include "core/red_map.h"
#include "planning/model_faces.h"

namespace dubsar {

/// A place on the measured surface, model frame.
struct SurfacePlace {
  Eigen::Vector3f position_mm{0, 0, 0};
  Eigen::Vector3f normal{0, 0, 1};  ///< unit, out of the clay, interpolated from the vertices
  Face face = Face::kObverse;
};

struct SurfacePlaces {
  std::vector<SurfacePlace> places;                   ///< each stands for the same area of measured surface
  std::array<double, kFaceCount> seen_mm2{};          ///< by Face, of faces without interpolated vertices
  std::array<double, kFaceCount> interpolated_mm2{};  ///< of the others
};

/// Spreads about `count` places evenly over the measured triangles of a mesh: every (area / count)-th square
/// millimetre along the list of triangles, at a position within its triangle that does not repeat. A triangle
/// belongs to the face that the surface around it looks to: normals averaged over cubes of a twenty-fifth of
/// the longest side. Triangles that are not sound are left out. Deterministic.
[[nodiscard]] SurfacePlaces surface_places(const Mesh& mesh, const ModelFaces& faces, std::size_t count);

}  // namespace dubsar
