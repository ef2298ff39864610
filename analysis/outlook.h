// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh.h"

namespace dubsar {

/// Which way the surface looks around each vertex, [V] unit: the area-weighted mean of the face normals
/// within about radius_mm (GigaMesh turns the patch of a vertex so before it measures integral invariants;
/// Mara 2012), gathered by cells of that size and blended between them, so that it varies smoothly. Zero
/// where no face with an area is near. The same for any number of threads.
[[nodiscard]] std::vector<Eigen::Vector3f> mean_outlook(const Mesh& mesh, double radius_mm);

}  // namespace dubsar
