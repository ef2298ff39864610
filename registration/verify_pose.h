// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/scan_pose.h"
#include "registration/model_fit.h"

namespace dubsar {

/// What a pose must show before it is accepted. Shares are of samples, in [0, 1].
struct VerifyOptions {
  double least_overlap =
      0.10;               ///< of the scan's samples on the model's surface, or of a smaller scan's on it
  int least_close = 300;  ///< samples, of the fine level
  // What speaks against a pose is added up, each in parts of what alone would be too much. Tuned on the
  // bunny, the dragon and a simulated tablet laid on its own back: right poses that carry a group stay below
  // 1, the wrong ones seen began at 1.6. Free space shows next to nothing against a right pose; a camera does
  // miss parts of a branched object that face it.
  double most_disagreement = 0.4;  ///< samples off the surface where both saw it
  double most_violation = 0.02;    ///< samples where another scan's rays went through
  double most_absence = 0.4;       ///< samples that another camera should have seen and did not
  double usual_residual = 0.75;    ///< rms over what noise and spacing explain, of a right pose …
  double most_residual = 1.7;      ///< … and where it alone is too much
  /// Where only the stage or a hand turn speaks for a pose, another tablet may lie there: the residuals must
  /// be what noise and spacing explain, to within so many standard deviations for as many independent places
  /// as the overlap holds. Right poses show 0.5 to 0.75 of it, other tablets of the same size from 1.24 on.
  double rig_residual_deviations = 3.0;
  double least_stability = 0.003;  ///< see IcpResult::stability; below, the scan can slide or turn …
  double most_slid = 0.6;          ///< … unless the relief agrees less than this part as well when it does
  /// Where the relief agrees this part as well slid, it makes no pose sure. Right poses reach 0.89 (200
  /// simulated ones, the bunny, the dragon); one on another tablet of the same size reached 1.06.
  double most_slid_held = 0.95;
  // The relief settles what the shape leaves open, and where nothing else speaks for a pose it must: a blank
  // tablet turned by half a turn fits its own back to within the noise. Among thousands of found poses the
  // wrong ones were seen to reach a significance of 4.7, where the lines of two sides fell together, and a
  // correlation of 0.24; the right pose of scans that share written clay shows 5 to 30 and 0.4 to 0.9.
  double sure_relief = 6.0;  ///< ModelFit::significance, and …
  double sure_correlation = 0.3;
  /// Of the significance what has to be left without what lies at sharp rims. Edges of a
  /// box laid on others of its edges kept 0.2 to 0.5 of 5 to 11; right poses 0.97 to 1.14.
  double least_off_rims = 0.7;
  /// Doubt that a sure pose may leave: scans that graze densely written clay agree in little more than half.
  double sure_doubt = 2.0;
  // Without relief a shape settles a pose when it is distinctive (ModelFit) and fits far better than it must.
  double shape_overlap = 0.35;
  double shape_agreement = 0.9;
  double shape_doubt = 0.5;
  double rival_relief = 0.5;  ///< a pose that shows less than this part of a sure one's is no rival to it
  // Tablets are nearly symmetric: a wrong pose seldom comes alone. How little may speak against the next pose
  // follows from how much speaks against the best: a right pose of a clean scan has next to none, and one of
  // a rough scan must stand alone. Measured with dubsar-false-accepts.
  double rival_score = 0.25;  ///< a pose with less than this part of another's score is no rival to it
  double rival_gap = 0.5;     ///< a rival must have this much against it …
  double rival_ratio = 6.0;   ///< … and this many times what speaks against the best
};

struct PoseVerdict {
  PoseStatus status = PoseStatus::kFailed;
  std::string reason;  ///< empty when registered; otherwise why, and what would settle it
};

/// True when the relief alone shows that the pose is right.
[[nodiscard]] bool sure(const ModelFit& fit, const VerifyOptions& options);

/// True when the residuals of a refined pose are larger than noise and spacing explain, whatever its relief
/// says: it is not the same clay, or one of the scans is bent.
[[nodiscard]] bool apart_beyond_noise(const ModelFit& fit, const VerifyOptions& options);

/// What is said of a scan that only the stage or a hand turn places, where the clay is not the same.
[[nodiscard]] std::string not_the_same_clay();

/// What speaks against a pose, 1 being too much.
[[nodiscard]] double doubt(const ModelFit& fit, const VerifyOptions& options);

/// Accept, ask or reject: the one place that decides. `fits` are the distinct poses found for a scan, by
/// falling score; of those that may be accepted, the one that least speaks against is moved to the front.
[[nodiscard]] PoseVerdict verify_pose(std::vector<ModelFit>& fits, const VerifyOptions& options);

/// Why a scan is unsure whose overlap lets it move: it `turns`, or else slides.
[[nodiscard]] std::string too_even(bool turns);
/// A reason without the advice to use pins, for a scan that has some.
[[nodiscard]] std::string without_pins_advised(std::string reason);

/// True when nothing that was seen contradicts the pose: what a scan needs whose pose the stage guarantees.
[[nodiscard]] bool consistent_pose(const ModelFit& fit, const VerifyOptions& options);

}  // namespace dubsar
