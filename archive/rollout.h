// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "archive/render.h"
#include "core/red_map.h"

namespace dubsar {

/// Clay that is drawn more than so many times as long as it is, along the curve, is left out. It lies deep
/// within the curve, as in a broken corner, where nothing can be unrolled to scale.
inline constexpr double kRolloutMostStretch = 3.0;

/// A side of the tablet, on the rollout.
struct RolloutSide {
  Face face = Face::kObverse;
  double from_mm = 0;  ///< where it begins: down from the upper edge
};

struct Rollout {
  Mesh mesh;
  std::array<RolloutSide, 4> sides;  ///< downwards; one ends where the next begins
};

/// The surface unrolled along the tablet's side curve (side_curve.h), as a relief over a plane: x to the
/// reader's right, y upwards against the way along the curve (obverse on top, below it bottom edge, reverse
/// and top edge), z how far outside of the curve. To scale along x, and along y where the clay lies on the
/// outline. The two long sides, which roll off to the left and right, stand steep at both ends. Faces across
/// the seam are cut there, one part for each end; colours and other values by vertex are not taken along.
/// Errors: kBadInput for a scene without a surface that has an extent, kCancelled.
[[nodiscard]] Result<Rollout> rolled_out(const RenderScene& scene, const RigidTransform& tablet_from_model,
                                         const JobContext& job);

/// How to look at it: straight on.
[[nodiscard]] ViewCamera rollout_camera();

/// The picture of it, on the ground of the options: at the right of the clay a tick and the name where each
/// side begins, below it a scale bar. Errors as of rolled_out() and render().
[[nodiscard]] Result<Image> rollout_picture(const RenderScene& scene, const RigidTransform& tablet_from_model,
                                            const RenderOptions& options, const JobContext& job);

}  // namespace dubsar
