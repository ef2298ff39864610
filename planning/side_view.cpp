// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/side_view.h"

namespace dubsar {

std::optional<NextView> side_view(const Rig& rig, const StageState& state, const PlacedScan& last,
                                  const ModelSurface& surface, double least_tilt_rad) {
  /// Well within the slope at which links grow longer than three spacings.
  constexpr double kSteepEnough = 0.5;
  Rig no_hands = rig;
  no_hands.hand_turns = false;
  const ViewCandidate* best = nullptr;
  double most = 0;
  const std::vector<ViewCandidate> candidates = rig_candidates(no_hands, state, last, surface);
  for (const ViewCandidate& candidate : candidates) {
    if (!candidate.placement || tilt_of(*candidate.placement) < least_tilt_rad) {
      continue;
    }
    const Eigen::Vector3d towards = candidate.model_from_scanner.rotation.col(2);
    double area = 0;
    for (const SurfacePatch& patch : surface.seen) {
      const bool hidden =
          candidate.hidden && candidate.hidden->normal.dot(patch.position_mm) < candidate.hidden->offset_mm;
      area += !hidden && patch.normal.dot(towards) > kSteepEnough ? patch.area_mm2 : 0.0;
    }
    if (area > most) {
      most = area;
      best = &candidate;
    }
  }
  if (best == nullptr) {
    return std::nullopt;
  }
  return NextView{best->model_from_scanner, 0.0, best->say, best->placement};
}

}  // namespace dubsar
