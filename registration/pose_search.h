// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/job.h"
#include "core/range_grid.h"
#include "registration/global_align.h"
#include "registration/model_fit.h"
#include "registration/verify_pose.h"

namespace dubsar {

struct PoseSearchOptions {
  GlobalAlignOptions align;
  ModelFitOptions fit;
  VerifyOptions verify;
  std::size_t batch = 2;         ///< scans of the model that are searched before looking whether it is enough
  double enough_overlap = 0.35;  ///< a verified pose with this overlap and agreement ends the search
  double enough_agreement = 0.75;
  double enough_significance = 10.0;  ///< as does a verified pose whose relief agrees like this
  double prior_sigmas = 4.0;          ///< poses farther from a nominal pose than this are out of the question
  double told_turn_rad = 0.35;        ///< a fit this near to what was told is what was told
  double told_mm = 5.0;
  double stage_sigmas = 8.0;  ///< a fit that leaves the stage's word by more is not believed
};

/// What the search is told of the scan beside its surface.
struct PoseHints {
  std::vector<RigidTransform> told;  ///< model_from_scanner: from labelled pins or from the operator
  /// As places have it that carry the same names in both scans, too few of them to be told: of these poses
  /// nobody asks whether the relief repeats.
  std::vector<RigidTransform> named;
  std::vector<RigidTransform> starts;  ///< model_from_scanner: to be tried, no more
  /// What the motors say when the model holds a scan of the same placement: model_from_scanner, good to
  /// sigma.
  std::optional<RigidTransform> stage;
  double stage_sigma_mm = 0.05;
  double stage_sigma_rad = 0.0005;
  /// What was asked of the operator's hands: model_from_scanner, good to hand_sigma.
  std::optional<RigidTransform> asked;
  double hand_sigma_mm = 3.0;
  double hand_sigma_rad = 0.1;
};

struct FoundPose {
  std::vector<ModelFit> fits;  ///< distinct, best first; empty when nothing was found
  PoseVerdict verdict;
  bool by_stage = false;  ///< the overlap is too poor to judge; the pose is the stage's word, uncontradicted
};

/// Pose hypotheses of the scan against scan k of the model: model_from_scanner of that scan's frame. May be
/// cached by the caller; must be safe to call from several threads.
using PairHypotheses = std::function<std::vector<PoseHypothesis>(std::size_t k)>;

/// Tells whether the surfaces that overlap in a fit are of a shape that does not come again
/// (self_similarity.h). May be cached by the caller.
using ShapeTest = std::function<bool(const ModelFit& fit)>;

/// By how much the scan can be turned (0: only shifted) so that the relief that speaks for a fit agrees as
/// well (self_similarity.h); nothing where it cannot. May be cached by the caller.
using ReliefTest = std::function<std::optional<double>(const ModelFit& fit)>;

/// Looks once more at what was found and is refused, or is not enough to end the search; true when it has
/// settled it. Then `found` holds what it accepted.
using SecondLook = std::function<bool(FoundPose& found)>;

/// Looks for the pose of a scan in a model: hints first, then the surface alone against one batch of the
/// model's scans after the other; everything that is found is refined against the whole model and judged
/// (verify_pose.h).
[[nodiscard]] FoundPose search_pose(const ScanSurface& scan, std::span<const ModelScan> model,
                                    const PoseHints& hints, const PairHypotheses& pair_hypotheses,
                                    const ShapeTest& shape_is_distinctive, const PoseSearchOptions& options,
                                    const JobContext& job, const SecondLook& second_look = {},
                                    const ReliefTest& relief_repeats = {});

}  // namespace dubsar
