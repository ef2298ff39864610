// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>

#include "archive/image.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// A pin as it is drawn, in the tablet frame.
struct PicturedPin {
  int number = 0;
  Eigen::Vector3d rim_mm{0, 0, 0};  ///< the point that the tip points at
  Eigen::Vector3d tip_mm{0, 0, 0};
  Eigen::Vector3d arm{0, 0, 1};  ///< unit, away from the tablet
};

/// One sheet of six views to scale (obverse, reverse and the four edges, unrolled as in six_views.h), tablet
/// and pins drawn, each pin's number beside its arm where its tip is in sight of the view. Arms are drawn
/// short. `tablet` is in the tablet frame: z out of the obverse, y to the top edge. Errors as render().
[[nodiscard]] Result<Image> pin_layout_picture(const Mesh& tablet, std::span<const PicturedPin> pins,
                                               const JobContext& job);

}  // namespace dubsar
