// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/render.h"
#include "core/red_map.h"

namespace dubsar {

/// Which way the clay about a place looks: the mean normal of the mesh within a few millimetres, or the
/// region's own where there is no such surface, or only that of the side opposite. A region's normal closes a
/// gap, which may be as narrow as a crack: people want to see it from where they would stand.
[[nodiscard]] Eigen::Vector3d outlook(const Mesh& mesh, const RedRegion& region);

/// A square picture of a place of the red map: the mesh within a few millimetres of it and what lies behind,
/// looked at along `towards_viewer` with the tablet as upright as it goes, lit like the other pictures,
/// `marks` painted over it and a ring as wide as the region round its centre. Errors as render().
[[nodiscard]] Result<Image> region_picture(const Mesh& mesh, const ColouredPoints& marks,
                                           const RedRegion& region, const Eigen::Vector3d& towards_viewer,
                                           const RigidTransform& tablet_from_model, const JobContext& job);

/// The face whose view shows best what looks that way.
[[nodiscard]] Face face_towards(const Eigen::Vector3d& direction, const RigidTransform& tablet_from_model);

/// A ring of `thickness_px` about (x, y).
void draw_ring(Image& image, double x, double y, double radius_px, double thickness_px, Rgb8 colour);

}  // namespace dubsar
