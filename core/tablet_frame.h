// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/mesh.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// Where a surface element lies and which way it looks.
struct SurfaceElement {
  Eigen::Vector3f position_mm{0, 0, 0};
  Eigen::Vector3f area_normal{0, 0, 0};  ///< out of the clay, as long as the element's area is large
};

/// tablet_from_model of a slab-like body: z across its two broad faces, x and y along its edges, the origin
/// at the middle of its bounding box. z is the axis of the largest second moment of the normals, x and y
/// follow from the fourfold moment of the normals of the edges. Geometry cannot tell the obverse from the
/// reverse nor top from bottom: of the eight ways to name the axes, the one nearest to the model's own axes
/// is taken, among those that keep z across the slab. A body that has no slab-like shape keeps the model's
/// axes; a slab without straight edges keeps the model's x as far as z allows. Elements that are not finite
/// are left out. Deterministic.
[[nodiscard]] RigidTransform tablet_frame(std::span<const SurfaceElement> surface);

/// The same from the faces of a mesh; indices out of range are left out.
[[nodiscard]] RigidTransform tablet_frame(const Mesh& mesh);

}  // namespace dubsar
