// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How the scans of a model are joined: searched, verified, connected.
#include <algorithm>

#include "registration/scan_model.h"
#include "registration/scan_motion.h"
#include "registration/second_body.h"
#include "registration/self_similarity.h"
#include "registration/without_foreign.h"

namespace dubsar {

namespace {

constexpr const char* kStopped = "registration was stopped; run it again";
constexpr const char* kContradiction =
    "it connects scans that contradict each other; one of them moved while it was scanned, or lies wrong: "
    "take that one out, or scan again what connects them";

/// Poses of an unsettled search that are kept for the next.
constexpr std::size_t kMostLeads = 5;

/// True when what is left of a scan whose other half lies elsewhere may show this much relief.
bool half_sure(const ModelFit& fit, const VerifyOptions& options) {
  return fit.significance >= 0.5 * options.sure_relief &&
         fit.relief.correlation() >= options.sure_correlation;
}

}  // namespace

bool ScanModel::join(int id, JobContext& job) {
  if (!scans_.at(id).usable) {
    return false;
  }
  bool joined = false;
  for (const int group : groups_by_size()) {
    if (job.cancelled()) {
      if (!joined && scans_.at(id).reason.empty()) {
        scans_.at(id).reason = kStopped;
      }
      break;
    }
    if (group != scans_.at(id).group) {
      joined = join_group(id, group, job) || joined;
    }
  }
  return joined;
}

void ScanModel::retry(JobContext& job) {
  bool grown = true;
  while (grown && !job.cancelled()) {
    grown = false;
    const int main = main_group();
    for (auto& [id, scan] : scans_) {
      if (!scan.usable || job.cancelled() || scan.group == main || scan.group == main_group()) {
        continue;
      }
      const std::vector<int> ids = members(main_group());
      if (std::any_of(ids.begin(), ids.end(),
                      [&known = scan.tried_on](int i) { return !known.contains(i); })) {
        grown = join_group(id, main_group(), job) || grown;
      }
    }
  }
}

bool ScanModel::join_group(int id, int group, JobContext& job) {
  Scan& scan = scans_.at(id);
  std::vector<int> ids = members(group);
  if (ids.empty()) {
    return false;  // it was joined with another meanwhile
  }
  const std::optional<int> hinted = hint_between(scan.group, group);
  if (!hinted) {
    return join_unhinted(id, ids, group, job);
  }
  const bool joined = join_by_hint(*hinted, job);
  const int for_id = stands_as(*hinted);
  std::erase(ids, for_id);
  if (joined || job.cancelled() || id == for_id || ids.empty()) {
    scan.tried_on.insert(ids.begin(), ids.end());
    scan.tried_on.insert(for_id);
    return joined;
  }
  // It is the hinted scan that a word which leads nowhere leaves out, not the one that it was said to lie on,
  // nor those that came with either.
  scan.tried_on.insert(for_id);
  if (!join_unhinted(id, ids, group, job)) {
    return false;
  }
  scans_.at(stands_as(hints_.at(*hinted).on)).hint_reason.clear();
  follow_hint(*hinted, job);
  return true;
}

bool ScanModel::join_unhinted(int id, const std::vector<int>& ids, int group, JobContext& job) {
  Scan& scan = scans_.at(id);
  if (scan.given) {
    return join_as_given(id, group, job);
  }
  const std::vector<ModelScan> model = model_of(ids);
  std::vector<std::uint8_t> searched(ids.size(), 0);
  const PairHypotheses from_pairs = [&](std::size_t k) {
    if (scan.tried_on.contains(ids[k])) {
      return std::vector<PoseHypothesis>{};
    }
    searched[k] = 1;
    return align_pair(scan.features, scans_.at(ids[k]).features, options_.search.align);
  };
  PoseHints hints = hints_for(scan, ids);
  for (const Lead& lead : scan.leads) {
    if (scans_.at(lead.on).group == group) {
      hints.starts.push_back(scans_.at(lead.on).group_from_scanner * lead.on_from_scanner);
    }
  }
  WithoutForeign without_foreign(*this, id, ids);
  FoundPose found = search_pose(
      *scan.features.surface, model, hints, from_pairs,
      [&](const ModelFit& fit) { return shape_is_distinctive(id, fit, ids); }, options_.search, job,
      [&](FoundPose& refused) { return without_foreign.settles(refused); },
      [&](const ModelFit& fit) { return relief_repeats(id, fit, ids); });
  if (!job.cancelled()) {
    for (std::size_t k = 0; k < ids.size(); ++k) {
      if (searched[k] != 0) {
        scan.tried_on.insert(ids[k]);
      }
    }
    std::erase_if(scan.leads, [&](const Lead& lead) { return scans_.at(lead.on).group == group; });
    for (std::size_t f = 0; f < std::min(found.fits.size(), kMostLeads); ++f) {
      scan.leads.push_back({ids.front(), scans_.at(ids.front()).group_from_scanner.inverse() *
                                             found.fits[f].model_from_scanner});
    }
  }
  if (found.verdict.status != PoseStatus::kRegistered || job.cancelled()) {
    // What the largest group says counts; groups are tried by size.
    if (measurements(members(scan.group)) == 1 && (group == main_group() || scan.reason.empty())) {
      scan.reason = job.cancelled() ? kStopped : found.verdict.reason;
      if (!found.fits.empty() && !job.cancelled() && half_sure(found.fits.front(), options_.search.verify)) {
        const std::optional<ScanMotion> motion =
            find_motion(*scan.features.surface, model, found.fits.front(), options_.search.fit);
        scan.reason = motion ? reason_of(*motion) : scan.reason;
      }
      scan.outcome =
          found.verdict.status == PoseStatus::kRegistered ? PoseStatus::kUnsure : found.verdict.status;
      if (!found.fits.empty()) {
        scan.rms_mm = found.fits.front().icp.rms_mm;
        scan.overlap = std::max(found.fits.front().overlap, found.fits.front().best_pair_overlap);
      }
    }
    return false;
  }
  // What was left out as a hand may be the tablet, and what stays what it lies on.
  const std::vector<ModelScan> whole_model = without_foreign.whole_model();
  if (const std::optional<SecondBody> body =
          find_second_body(without_foreign.whole(), features_of(ids), whole_model, found.fits.front(),
                           options_.surface, options_.search, job)) {
    scan.reason = reason_of(*body);
    scan.outcome = PoseStatus::kUnsure;
    return false;
  }
  if (!groups_agree(id, found.fits.front().model_from_scanner, ids) &&
      (!without_foreign.settles(found) || !groups_agree(id, found.fits.front().model_from_scanner, ids))) {
    scan.reason = kContradiction;
    scan.outcome = PoseStatus::kUnsure;
    return false;
  }
  without_foreign.keep();
  connect(id, found.fits.front(), found.by_stage, ids, group);
  settle_group(scans_.at(id).group, job);
  judge(id);
  return true;
}

bool ScanModel::shape_is_distinctive(int id, const ModelFit& fit, const std::vector<int>& group_ids) {
  const auto similar = [&](int i) {
    Scan& scan = scans_.at(i);
    if (!scan.self_similar) {
      scan.self_similar = self_similar(*scan.features.surface, options_.search.fit, options_.search.verify);
    }
    return *scan.self_similar;
  };
  return !similar(id) && std::none_of(fit.targets.begin(), fit.targets.end(),
                                      [&](std::size_t k) { return similar(group_ids[k]); });
}

std::optional<double> ScanModel::relief_repeats(int id, const ModelFit& fit,
                                                const std::vector<int>& group_ids) {
  const auto repeats = [&](int i) {
    Scan& scan = scans_.at(i);
    if (!scan.relief_repeats) {
      scan.relief_repeats =
          find_relief_repeats(*scan.features.surface, options_.search.fit, options_.search.verify);
    }
    return repeats_as_well(*scan.relief_repeats, fit.relief, options_.search.verify);
  };
  if (const std::optional<double> turn_rad = repeats(id)) {
    return turn_rad;
  }
  std::optional<double> repeated;
  std::vector<int> telling;
  for (const std::size_t k : fit.touching) {
    if (const std::optional<double> turn_rad = repeats(group_ids[k])) {
      repeated = turn_rad;
    } else {
      telling.push_back(group_ids[k]);
    }
  }
  if (!repeated || telling.empty()) {
    return repeated;
  }
  // What the others say alone. That it does not slide was asked of all.
  ModelFit told = fit;
  told.slid_significance = 0;
  told.relief = judge_in_model(*scans_.at(id).features.surface, model_of(telling), fit.model_from_scanner,
                               options_.search.fit)
                    .relief;
  told.significance = told.relief.significance(scans_.at(id).features.surface->relief.radius_mm);
  told.significance_off_rims =
      told.relief.significance_off_rims(scans_.at(id).features.surface->relief.radius_mm);
  return sure(told, options_.search.verify) ? std::nullopt : repeated;
}

bool ScanModel::groups_agree(int id, const RigidTransform& group_from_scanner,
                             const std::vector<int>& group_ids) const {
  const Scan& scan = scans_.at(id);
  const std::vector<ModelScan> model = model_of(group_ids);
  const RigidTransform group_from_own = group_from_scanner * scan.group_from_scanner.inverse();
  PoseEvidence brought;
  for (const int other : members(scan.group)) {
    if (other != id) {
      const Scan& moved = scans_.at(other);
      brought.add(judge_in_model(*moved.features.surface, model, group_from_own * moved.group_from_scanner,
                                 options_.search.fit)
                      .both());
    }
  }
  // Free space only: until all are relaxed together, a small turn of the one scan carries the others off.
  return brought.violation() <= options_.search.verify.most_violation;
}

void ScanModel::connect(int id, const ModelFit& fit, bool by_stage, const std::vector<int>& fitted_ids,
                        int group) {
  Scan& scan = scans_.at(id);
  const std::vector<int> group_ids = members(group);
  scan.stage_sigma_mm = by_stage && scan.nominal ? scan.nominal->sigma_mm : 0.0;
  const int own = scan.group;
  const std::vector<int> own_ids = members(own);
  const RigidTransform group_from_own = fit.model_from_scanner * scan.group_from_scanner.inverse();
  // The larger group keeps its frame, so that what was stitched stays in place; so does one with a locked
  // scan.
  const auto locked = [&](const std::vector<int>& ids) {
    return std::any_of(ids.begin(), ids.end(), [&](int i) { return scans_.at(i).is_locked(); });
  };
  const std::size_t own_size = measurements(own_ids);
  const std::size_t group_size = measurements(group_ids);
  const bool own_moves =
      locked(own_ids) == locked(group_ids)
          ? own_size < group_size || (own_size == group_size && group_ids.front() < own_ids.front())
          : locked(group_ids);
  const RigidTransform move = own_moves ? group_from_own : group_from_own.inverse();
  for (const int i : own_moves ? own_ids : group_ids) {
    Scan& moved = scans_.at(i);
    moved.group_from_scanner = (move * moved.group_from_scanner).orthonormalised();
    moved.group = own_moves ? group : own;
  }
  for (const int i : own_moves ? group_ids : own_ids) {
    scans_.at(i).group = own_moves ? group : own;
  }
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(fit.touching.size());
  unchecked_.insert(id);
  for (const std::size_t k : fit.touching) {
    pairs.push_back(std::minmax(id, fitted_ids[k]));
    unchecked_.insert(fitted_ids[k]);
  }
  measure_pairs(pairs);
  const std::vector<int> joined = members(scan.group);
  if (measurements(joined) == 1) {
    return;  // that a scan and its part fit each other settles nothing of what is wrong with either
  }
  for (const int i : joined) {
    scans_.at(i).fault_reason.clear();
  }
  scan.reason.clear();
}

}  // namespace dubsar
