// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "acquisition/calibration_views.h"

namespace dubsar {

/// A point of the laser's stripe on a board of known pose.
struct StripeSample {
  std::size_t view = 0;  ///< index into Intrinsics::used
  Eigen::Vector2d pixel{0, 0};
  Eigen::Vector3d point_mm{0, 0, 0};  ///< camera frame
};

/// The stripe points that lie on the printed board or on the plate up to margin_mm around it, at most
/// `most_per_view` of each view, evenly spread.
[[nodiscard]] std::vector<StripeSample> stripe_samples(const std::vector<CalibrationView>& views,
                                                       const Intrinsics& intrinsics, const BoardSpec& board,
                                                       double margin_mm = 0, std::size_t most_per_view = 120);

struct PlaneFit {
  Plane plane;
  double rms_mm = 0;                 ///< of the inliers
  std::vector<std::uint8_t> inlier;  ///< [points]
  double spread_mm = 0;  ///< standard deviation of the points along their second direction: 0 is a line
};

/// Total least squares over all points, those that stray too.
[[nodiscard]] PlaneFit least_squares_plane(const std::vector<Eigen::Vector3d>& points_mm);

/// A plane through points of which up to a third may be wrong: three-point samples (seeded), then total least
/// squares over what lies within three times the median distance. Samples are judged by a part of many
/// points. Errors (kBadInput): fewer than 10 points, or all on a line.
[[nodiscard]] Result<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points_mm);

}  // namespace dubsar
