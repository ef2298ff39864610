// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "archive/render_scene.h"
#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// A closed line in a camera's picture plane: x to the right, y up, mm.
using OutlineRing = std::vector<Eigen::Vector2d>;

/// The silhouette of what is drawn, from a picture of longest_px, simplified to half a pixel: rings round
/// what is covered counter-clockwise, round holes clockwise; specks of a few pixels are left out. Errors as
/// framing_of().
[[nodiscard]] Result<std::vector<OutlineRing>> outline_of(const RenderScene& scene, const ViewCamera& camera,
                                                          int longest_px);

}  // namespace dubsar
