// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/render.h"
#include "core/red_map.h"

namespace dubsar {

/// A square picture of a place of the red map: the mesh within a few millimetres of it, looked at along the
/// region's normal with the tablet as upright as it goes, lit like the other pictures, `marks` painted over
/// it and a ring as wide as the region round its centre. Errors as render().
[[nodiscard]] Result<Image> region_picture(const Mesh& mesh, const ColouredPoints& marks,
                                           const RedRegion& region, const RigidTransform& tablet_from_model,
                                           const JobContext& job);

/// A ring of `thickness_px` about (x, y).
void draw_ring(Image& image, double x, double y, double radius_px, double thickness_px, Rgb8 colour);

}  // namespace dubsar
