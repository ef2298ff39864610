// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "registration/icp.h"
#include "registration/pose_evidence.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// A scan of the model that others are fitted to.
struct ModelScan {
  const ScanSurface* surface = nullptr;
  RigidTransform model_from_scanner;
};

struct ModelFitOptions {
  // Lengths are parts of the surfaces' common scale where they are not in millimetres.
  int most_medium = 5;    ///< distinct starts that are refined on the medium level
  int most_fine = 3;      ///< and on the fine one
  double hopeless = 0.4;  ///< starts with less than this part of the best one's score are not refined
  double coarse_tolerance = 0.02;
  double band = 0.08;
  double distinct_turn_rad = 0.15;
  double distinct_shift = 0.04;
  double systematic_of_spacing =
      0.2;                         ///< residual that sampling and calibration leave, of µ, beside the noise
  double tolerance_sigmas = 3.0;   ///< of a sample that lies on the other surface
  int least_overlap_samples = 30;  ///< of the coarse level, for a scan to take part in the fit of another
  /// A fit whose relief agrees less than this before the fine level is not refined: it could not be accepted.
  /// 0 where more than the surface speaks for the starts.
  double least_significance = 2.5;
  bool starts_are_close = false;  ///< to within the fine level's reach: nothing coarser is needed
  std::size_t most_targets = 6;   ///< scans that one is fitted to at once: those with the largest overlap
};

/// A pose of a scan in the model and everything that speaks for and against it.
struct ModelFit {
  RigidTransform model_from_scanner;
  IcpResult icp;  ///< of the fine level
  PoseEvidence
      outward;  ///< the scan's samples among what the model's cameras saw (summed over the model's scans)
  PoseEvidence inward;           ///< the model's samples in what the scan's camera saw
  double overlap = 0;            ///< share of the scan's samples that lie on a surface of the model
  double best_pair_overlap = 0;  ///< largest overlap with one scan of the model, over the smaller of the two
  double partner_agreement = 0;  ///< PoseEvidence::agreement() with the one scan that it shares most with
  double residual_sigma_mm = 0;  ///< expected standard deviation of a residual
  ReliefAgreement relief;        ///< with all scans of the model
  double significance = 0;       ///< of the relief's agreement, in standard deviations
  double significance_off_rims = 0;  ///< of what of it is not at sharp rims, which are alike everywhere
  double slid_significance =
      0;              ///< the larger one of the scan moved either way along the ICP's weakest direction
  double places = 0;  ///< independent ones that the common surface holds (ReliefAgreement)
  double score = 0;   ///< for comparing poses of one scan: pose_support()
  bool told = false;  ///< more than the surface speaks for the pose: pins, the stage or the operator
  bool told_by_rig = false;  ///< by the stage or a hand turn, which do not know what tablet lies there
  /// Its relief fits as well turned by so much, so that it tells no pose (self_similarity.h).
  std::optional<double> repeats_turned_rad;
  bool distinctive = false;           ///< the shape of what overlaps is like nothing else on the object
  std::vector<std::size_t> touching;  ///< positions in the model of the scans that it overlaps
  std::vector<std::size_t> targets;   ///< those of them that it is fitted to

  /// False for a rough pose that was not worth the fine level: it must not be accepted.
  [[nodiscard]] bool refined() const { return icp.pairs > 0; }
  [[nodiscard]] PoseEvidence both() const {
    PoseEvidence sum = outward;
    sum.add(inward);
    return sum;
  }
};

/// Expected standard deviation of a point-to-plane residual between two scans in their right places, fine
/// level.
[[nodiscard]] double residual_sigma_mm(const ScanSurface& a, const ScanSurface& b,
                                       const ModelFitOptions& options);

/// One level of the members of the model, for others to be fitted to.
[[nodiscard]] std::vector<IcpTarget> targets_of(std::span<const ModelScan> model,
                                                const std::vector<std::size_t>& members,
                                                std::unique_ptr<SurfaceLevel> ScanSurface::*level);

/// The last steps of a fit, from within the fine level's reach; residual_sigma_mm as in ModelFit.
[[nodiscard]] IcpResult refine_fine(const SurfaceLevel& source, std::span<const IcpTarget> targets,
                                    const RigidTransform& start, double residual_sigma_mm);

/// What a part of the scan says of a pose, fine level, over the targets in the model.
[[nodiscard]] PoseEvidence evidence_of_part(const SurfaceLevel& part, const ScanSurface& scan,
                                            std::span<const ModelScan> model,
                                            const std::vector<std::size_t>& targets,
                                            const RigidTransform& model_from_scanner,
                                            const ModelFitOptions& options);

/// Counts the evidence for a given pose without moving it; `icp` stays empty.
[[nodiscard]] ModelFit judge_in_model(const ScanSurface& scan, std::span<const ModelScan> model,
                                      const RigidTransform& model_from_scanner,
                                      const ModelFitOptions& options);

/// Refines the starts from coarse to fine against all scans of the model at once. Returns distinct fits, best
/// first; none is verified (verify_pose.h).
[[nodiscard]] std::vector<ModelFit> fit_to_model(const ScanSurface& scan, std::span<const ModelScan> model,
                                                 std::span<const RigidTransform> starts,
                                                 const ModelFitOptions& options);

}  // namespace dubsar
