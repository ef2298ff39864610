// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pose_search.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/units.h"
#include "registration/align_near.h"
#include "registration/self_similarity.h"

namespace dubsar {

namespace {

/// Poses whose shape is looked at when no relief settles one.
constexpr std::size_t kMostByShape = 3;

/// Adds fits that are no copies of known ones, best first.
void merge(std::vector<ModelFit>& into, std::vector<ModelFit> more, const ScanSurface& scan,
           const ModelFitOptions& options) {
  for (ModelFit& fit : more) {
    into.push_back(std::move(fit));
  }
  std::stable_sort(into.begin(), into.end(),
                   [](const ModelFit& a, const ModelFit& b) { return a.score > b.score; });
  std::vector<ModelFit> kept;
  for (ModelFit& fit : into) {
    const auto copy = std::find_if(kept.begin(), kept.end(), [&](const ModelFit& k) {
      return same_pose(fit.model_from_scanner, k.model_from_scanner, scan.centroid_mm,
                       options.distinct_turn_rad, options.distinct_shift * scan.scale_mm);
    });
    if (copy == kept.end()) {
      kept.push_back(std::move(fit));
    } else if (fit.refined() && !copy->refined()) {
      // A rough pose may look better by chance; only the refined one may be accepted.
      *copy = std::move(fit);
    }
  }
  into = std::move(kept);
}

/// Half turns under which a nearly symmetric tablet would look the same: about the principal axes of the
/// model, of the scan and of both together, through the middles of each. A pose that holds must outdo them.
std::vector<RigidTransform> half_turns(const ScanSurface& scan, std::span<const ModelScan> model,
                                       const RigidTransform& pose) {
  std::vector<Eigen::Vector3d> of_model;
  for (const ModelScan& m : model) {
    for (const SurfaceSample& s : m.surface->coarse->samples) {
      of_model.push_back(m.model_from_scanner * Eigen::Vector3d(s.position_mm.cast<double>()));
    }
  }
  std::vector<Eigen::Vector3d> of_scan;
  for (const SurfaceSample& s : scan.coarse->samples) {
    of_scan.push_back(pose * Eigen::Vector3d(s.position_mm.cast<double>()));
  }
  std::vector<Eigen::Vector3d> of_both = of_model;
  of_both.insert(of_both.end(), of_scan.begin(), of_scan.end());
  std::vector<RigidTransform> out;
  for (const std::vector<Eigen::Vector3d>* points : {&of_both, &of_model, &of_scan}) {
    for (const RigidTransform& symmetry : likely_symmetries(*points, false)) {
      out.push_back(symmetry * pose);
    }
  }
  return out;
}

bool near_asked(const RigidTransform& pose, const PoseHints& hints, const ScanSurface& scan,
                const PoseSearchOptions& options) {
  if (!hints.asked) {
    return true;
  }
  // Two hand turns stand between two placements.
  const double sigmas = options.prior_sigmas * std::sqrt(2.0);
  const RigidTransform turn{pose.rotation * hints.asked->rotation.transpose(), {0, 0, 0}};
  const double lever = hints.hand_sigma_rad * scan.scale_mm;
  return turn.angle_rad() <= sigmas * hints.hand_sigma_rad &&
         (pose * scan.centroid_mm - *hints.asked * scan.centroid_mm).norm() <=
             sigmas * std::hypot(hints.hand_sigma_mm, lever);
}

bool enough(const FoundPose& found, const PoseSearchOptions& options) {
  return found.verdict.status == PoseStatus::kRegistered &&
         (found.fits.front().significance >= options.enough_significance ||
          (found.fits.front().overlap >= options.enough_overlap &&
           found.fits.front().both().agreement() >= options.enough_agreement));
}

}  // namespace

FoundPose search_pose(const ScanSurface& scan, std::span<const ModelScan> model, const PoseHints& hints,
                      const PairHypotheses& pair_hypotheses, const ShapeTest& shape_is_distinctive,
                      const PoseSearchOptions& options, const JobContext& job, const SecondLook& second_look,
                      const ReliefTest& relief_repeats) {
  FoundPose found;
  const auto settled_by_second_look = [&] {
    return found.verdict.status != PoseStatus::kRegistered && second_look && !job.cancelled() &&
           second_look(found);
  };
  const auto is_near = [&](const ModelFit& fit, const std::vector<RigidTransform>& poses) {
    return std::ranges::any_of(poses, [&](const RigidTransform& pose) {
      return same_pose(fit.model_from_scanner, pose, scan.centroid_mm, options.told_turn_rad,
                       options.told_mm);
    });
  };
  // Only of what would be accepted by its relief: it costs fits of the scans on themselves.
  const auto ask_relief = [&](std::vector<ModelFit>& fits) {
    for (ModelFit& fit : fits) {
      if (relief_repeats && !fit.told && sure(fit, options.verify) && !is_near(fit, hints.named)) {
        fit.repeats_turned_rad = relief_repeats(fit);
      }
    }
  };
  const auto take = [&](std::vector<ModelFit> fits) {
    std::erase_if(fits,
                  [&](const ModelFit& f) { return !near_asked(f.model_from_scanner, hints, scan, options); });
    for (ModelFit& fit : fits) {
      const bool by_pins = is_near(fit, hints.told);
      fit.told = hints.asked.has_value() || by_pins;
      fit.told_by_rig = hints.asked.has_value() && !by_pins;
    }
    ask_relief(fits);
    merge(found.fits, std::move(fits), scan, options.fit);
    found.verdict = verify_pose(found.fits, options.verify);
  };
  ModelFitOptions told_fit = options.fit;
  told_fit.least_significance = 0;  // more than the surface speaks for these starts
  const auto look = [&](std::span<const RigidTransform> starts, bool told = false) {
    take(fit_to_model(scan, model, starts, told ? told_fit : options.fit));
  };

  // What relief does not settle the shape may, where it is like nothing else: the fits so far were not worth
  // refining by their relief.
  const auto look_by_shape = [&] {
    std::vector<RigidTransform> starts;
    std::erase_if(found.fits, [&](const ModelFit& fit) {
      const bool taken = fit.overlap >= 0.5 * options.verify.shape_overlap && starts.size() < kMostByShape;
      if (taken) {
        starts.push_back(fit.model_from_scanner);
      }
      return taken;
    });
    if (starts.empty()) {
      return;
    }
    ModelFitOptions close = options.fit;
    close.starts_are_close = true;
    close.least_significance = 0;
    std::vector<ModelFit> fits = fit_to_model(scan, model, starts, close);
    for (ModelFit& fit : fits) {
      fit.distinctive = fit.overlap >= options.verify.shape_overlap && shape_is_distinctive(fit);
    }
    ask_relief(fits);
    merge(found.fits, std::move(fits), scan, options.fit);
    found.verdict = verify_pose(found.fits, options.verify);
  };

  if (hints.stage) {
    const RigidTransform& stage = *hints.stage;
    ModelFitOptions close = options.fit;
    close.starts_are_close = true;
    close.least_significance = 0;
    std::vector<ModelFit> fits = fit_to_model(scan, model, {&stage, 1}, close);
    for (ModelFit& fit : fits) {
      fit.told = true;
      fit.told_by_rig = true;
    }
    const bool other_clay = std::ranges::any_of(fits, [&](const ModelFit& fit) {
      return !sure(fit, options.verify) && apart_beyond_noise(fit, options.verify);
    });
    std::erase_if(fits, [&](const ModelFit& f) {
      return !same_pose(
          f.model_from_scanner, stage, scan.centroid_mm,
          options.stage_sigmas * std::max(hints.stage_sigma_rad, 1e-4) + 0.002,
          options.stage_sigmas * std::max(hints.stage_sigma_mm, 1e-3) + 2.0 * scan.fine->spacing_mm);
    });
    PoseVerdict verdict = verify_pose(fits, options.verify);
    if (verdict.status == PoseStatus::kRegistered) {
      return {std::move(fits), verdict, false};
    }
    ModelFit as_told = judge_in_model(scan, model, stage, options.fit);
    if (!other_clay && consistent_pose(as_told, options.verify)) {
      return {{std::move(as_told)}, {PoseStatus::kRegistered, {}}, true};
    }
    // Where the fit lies as the stage says, it is the clay that differs.
    found.verdict = {
        PoseStatus::kUnsure,
        other_clay && !fits.empty()
            ? not_the_same_clay()
            : "it contradicts the stage's pose; check that the tablet did not move between the scans"};
    found.fits.push_back(std::move(as_told));
    settled_by_second_look();
    return found;
  }
  bool settled = false;
  if (!hints.told.empty()) {
    look(hints.told, true);
    settled = enough(found, options) || settled_by_second_look();
  }
  if (!hints.starts.empty() && !settled) {
    look(hints.starts);
    settled = enough(found, options) || settled_by_second_look();
  }
  if (hints.asked && !settled) {
    AlignNearOptions near;
    near.fit = told_fit;
    near.verify = options.verify;
    take(align_near(scan, model, *hints.asked, near));
    settled = enough(found, options) || settled_by_second_look();
  }
  if (hints.asked && settled) {
    return found;  // a half turn is far from what was asked for
  }
  for (std::size_t begin = 0; begin < model.size() && !settled && !job.cancelled(); begin += options.batch) {
    const std::size_t end = std::min(begin + options.batch, model.size());
    std::vector<std::vector<PoseHypothesis>> hypotheses(end - begin);
    parallel_for_each_index(
        end - begin, [&](std::size_t k) { hypotheses[k] = pair_hypotheses(begin + k); }, 1);
    std::vector<RigidTransform> starts;
    for (std::size_t k = begin; k < end; ++k) {
      for (const PoseHypothesis& h : hypotheses[k - begin]) {
        starts.push_back(model[k].model_from_scanner * h.target_from_source);
      }
    }
    if (starts.empty()) {
      continue;
    }
    look(starts, hints.asked.has_value());
    settled = enough(found, options) || settled_by_second_look();
  }
  if (found.verdict.status != PoseStatus::kRegistered && !found.fits.empty() && !job.cancelled()) {
    look_by_shape();
  }
  // Relief that agrees beyond doubt has no rival.
  if (found.verdict.status == PoseStatus::kRegistered && !job.cancelled() &&
      found.fits.front().significance < options.enough_significance) {
    // Few at a time: the fit refines only the best starts of a batch, and a rival must not be crowded out.
    const std::vector<RigidTransform> turns = half_turns(scan, model, found.fits.front().model_from_scanner);
    for (std::size_t k = 0; k + 1 < turns.size() && found.verdict.status == PoseStatus::kRegistered; k += 2) {
      look(std::span(turns).subspan(k, 2));
    }
  }
  if (found.fits.empty()) {
    found.verdict = verify_pose(found.fits, options.verify);
  }
  return found;
}

}  // namespace dubsar
