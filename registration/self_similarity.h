// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <vector>

#include "registration/scan_surface.h"
#include "registration/verify_pose.h"

namespace dubsar {

/// True when the scan, turned by a half or a quarter turn about one of its own axes, lies on itself as well
/// as it does unturned: a tablet, a ball, a rim. Its shape alone then tells no pose, for what fits here would
/// fit there, and there may be where nobody has looked.
[[nodiscard]] bool self_similar(const ScanSurface& scan, const ModelFitOptions& fit,
                                const VerifyOptions& verify);

/// A pose of a scan on itself, other than the one that it has, in which its relief agrees with itself.
struct ReliefRepeat {
  double turn_rad = 0;
  Correlation height, tone;
};

/// Where the relief of a scan repeats: turned by half a turn about one of its own axes, or moved along one,
/// as even rulings and rolled seals do. Only what its shape allows, and what is beyond chance. None of a scan
/// of written clay, of the bunny and of the dragon reached a significance of 5; of even rulings 9 to 21.
[[nodiscard]] std::vector<ReliefRepeat> find_relief_repeats(const ScanSurface& scan,
                                                            const ModelFitOptions& fit,
                                                            const VerifyOptions& verify);

/// By how much the scan is turned where its relief repeats as well as it agrees in a pose (nearly, by
/// Fisher's z for one place); of height and tone what speaks for that pose counts. Nothing where it does not.
[[nodiscard]] std::optional<double> repeats_as_well(const std::vector<ReliefRepeat>& repeats,
                                                    const ReliefAgreement& pose, const VerifyOptions& verify);

/// Half turns (and quarter turns, when asked for) about the principal axes of the points through the middle
/// of their extent and through their mean: those under which man-made things look the same.
[[nodiscard]] std::vector<RigidTransform> likely_symmetries(const std::vector<Eigen::Vector3d>& points_mm,
                                                            bool quarters);

}  // namespace dubsar
