// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/render_scene.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// The surface unrolled along the tablet's side curve (side_curve.h), as a relief over a plane: x to the
/// reader's right, y upwards against the way along the curve (obverse on top, below it bottom edge, reverse
/// and top edge), z how far outside of the curve. To scale along x, and along y where the clay lies on the
/// curve. The two long sides, which roll off to the left and right, stand steep at both ends. Faces across
/// the seam are left out; colours and other values by vertex are not taken along. Errors: kBadInput for a
/// scene without a surface that has an extent, kCancelled.
[[nodiscard]] Result<Mesh> rolled_out(const RenderScene& scene, const RigidTransform& tablet_from_model,
                                      const JobContext& job);

/// How to look at it: straight on.
[[nodiscard]] ViewCamera rollout_camera();

}  // namespace dubsar
