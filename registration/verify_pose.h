// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <string>

#include "core/scan_pose.h"
#include "registration/model_fit.h"

namespace dubsar {

/// What a pose must show before it is accepted. Shares are of samples, in [0, 1].
struct VerifyOptions {
  double least_overlap = 0.10;        ///< of the scan's samples on the model's surface
  int least_close = 300;              ///< samples, of the fine level
  double least_agreement = 0.60;      ///< of the samples where both saw the surface
  double most_violation = 0.05;       ///< that stand where another scan's rays went through
  double most_absence = 0.25;         ///< that another camera should have seen and did not
  double most_residual_sigmas = 2.0;  ///< rms residual against what noise and spacing explain
  double least_stability = 0.0015;    ///< see IcpResult::stability; below, the scan can slide or turn
  double rival_score = 0.5;  ///< a second pose with more than this part of the best one's score is a rival …
  double rival_agreement = 0.5;  ///< … when its samples agree at least like this
};

struct PoseVerdict {
  PoseStatus status = PoseStatus::kFailed;
  std::string reason;  ///< empty when registered; otherwise why, and what would settle it
};

/// Accept, ask or reject: the one place that decides. `fits` are the distinct poses found for a scan, best
/// first.
[[nodiscard]] PoseVerdict verify_pose(std::span<const ModelFit> fits, const VerifyOptions& options);

/// True when nothing that was seen contradicts the pose: what a scan needs whose pose the stage guarantees.
[[nodiscard]] bool consistent_pose(const ModelFit& fit, const VerifyOptions& options);

}  // namespace dubsar
