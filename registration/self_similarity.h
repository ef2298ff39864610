// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "registration/scan_surface.h"
#include "registration/verify_pose.h"

namespace dubsar {

/// True when the scan, turned by a half or a quarter turn about one of its own axes, lies on itself as well
/// as it does unturned: a tablet, a ball, a rim. Its shape alone then tells no pose, for what fits here would
/// fit there, and there may be where nobody has looked.
[[nodiscard]] bool self_similar(const ScanSurface& scan, const ModelFitOptions& fit,
                                const VerifyOptions& verify);

/// Half turns (and quarter turns, when asked for) about the principal axes of the points through the middle
/// of their extent and through their mean: those under which man-made things look the same.
[[nodiscard]] std::vector<RigidTransform> likely_symmetries(const std::vector<Eigen::Vector3d>& points_mm,
                                                            bool quarters);

}  // namespace dubsar
