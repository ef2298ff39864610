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
  double least_overlap = 0.10;  ///< of the scan's samples on the model's surface
  int least_close = 300;        ///< samples, of the fine level
  // What speaks against a pose is added up, each in parts of what alone would be too much. Tuned on the
  // bunny, the dragon and a simulated tablet laid on its own back: right poses that carry a group stay below
  // 1, the wrong ones seen began at 1.6. Free space shows next to nothing against a right pose; a camera does
  // miss parts of a branched object that face it.
  double most_disagreement = 0.4;  ///< samples off the surface where both saw it
  double most_violation = 0.02;    ///< samples where another scan's rays went through
  double most_absence = 0.4;       ///< samples that another camera should have seen and did not
  double usual_residual = 0.75;    ///< rms over what noise and spacing explain, of a right pose …
  double most_residual = 1.7;      ///< … and where it alone is too much
  double least_stability = 0.003;  ///< see IcpResult::stability; below, the scan can slide or turn
  double rival_score = 0.5;  ///< a second pose with more than this part of the best one's score is a rival …
  double rival_doubt = 1.5;  ///< … when no more than this speaks against it
};

struct PoseVerdict {
  PoseStatus status = PoseStatus::kFailed;
  std::string reason;  ///< empty when registered; otherwise why, and what would settle it
};

/// What speaks against a pose, 1 being too much.
[[nodiscard]] double doubt(const ModelFit& fit, const VerifyOptions& options);

/// Accept, ask or reject: the one place that decides. `fits` are the distinct poses found for a scan, best
/// first.
[[nodiscard]] PoseVerdict verify_pose(std::span<const ModelFit> fits, const VerifyOptions& options);

/// True when nothing that was seen contradicts the pose: what a scan needs whose pose the stage guarantees.
[[nodiscard]] bool consistent_pose(const ModelFit& fit, const VerifyOptions& options);

}  // namespace dubsar
