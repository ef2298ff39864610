// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The operator's word on single scans: hints, locks and given poses. The third part of ScanModel.
#include <algorithm>

#include "registration/hint_starts.h"
#include "registration/point_pairs.h"
#include "registration/scan_model.h"
#include "registration/without_foreign.h"

namespace dubsar {

namespace {

/// Starts per fit: it refines only the best few of a batch, and the right one must not be crowded out.
constexpr std::size_t kBatch = 6;

/// A pose that was found anew is the locked one when it is no farther from it than this, over the scan: poses
/// that the surfaces hold no better are not registered at all (scan_model.cpp).
constexpr double kMostLockMissMm = 0.5;
constexpr double kMostLockMissSpacings = 3.0;

}  // namespace

std::optional<int> ScanModel::hint_between(int a, int b) const {
  for (const auto& [id, hint] : hints_) {
    const auto scan = scans_.find(stands_as(id));
    const auto on = scans_.find(stands_as(hint.on));
    if (scan == scans_.end() || on == scans_.end() || !scan->second.usable || !on->second.usable) {
      continue;
    }
    const int own = scan->second.group;
    const int other = on->second.group;
    if ((own == a && other == b) || (own == b && other == a)) {
      return id;
    }
  }
  return std::nullopt;
}

bool ScanModel::hints_hold(int id, int group, const RigidTransform& group_from_scanner) const {
  const Scan& scan = scans_.at(id);
  const RigidTransform group_from_own = group_from_scanner * scan.group_from_scanner.inverse();
  const auto in_group = [&](const Scan& s) {
    return s.group == group ? s.group_from_scanner : group_from_own * s.group_from_scanner;
  };
  return std::all_of(hints_.begin(), hints_.end(), [&](const auto& entry) {
    const auto hinted = scans_.find(stands_as(entry.first));
    const auto on = scans_.find(stands_as(entry.second.on));
    if (hinted == scans_.end() || on == scans_.end() || !hinted->second.usable || !on->second.usable) {
      return true;
    }
    const bool spans = (hinted->second.group == scan.group && on->second.group == group) ||
                       (hinted->second.group == group && on->second.group == scan.group);
    return !spans ||
           agrees_with(hint_for(entry.first), in_group(on->second).inverse() * in_group(hinted->second),
                       hinted->second.features.surface->centroid_mm);
  });
}

bool ScanModel::join_from(int id, int group, const std::vector<RigidTransform>& starts, JobContext& job) {
  Scan& scan = scans_.at(id);
  const std::vector<int> ids = members(group);
  const std::vector<ModelScan> model = model_of(ids);
  scan.tried_on.insert(ids.begin(), ids.end());
  ModelFitOptions fit_options = options_.search.fit;
  fit_options.least_significance = 0;
  std::vector<ModelFit> fits;
  for (std::size_t k = 0; k < starts.size() && !job.cancelled(); k += kBatch) {
    for (ModelFit& fit :
         fit_to_model(*scan.features.surface, model,
                      std::span(starts).subspan(k, std::min(kBatch, starts.size() - k)), fit_options)) {
      fit.told = true;
      const auto copy = std::find_if(fits.begin(), fits.end(), [&](const ModelFit& known) {
        return same_pose(fit.model_from_scanner, known.model_from_scanner, scan.features.surface->centroid_mm,
                         options_.search.fit.distinct_turn_rad,
                         options_.search.fit.distinct_shift * scan.features.surface->scale_mm);
      });
      if (!hints_hold(id, group, fit.model_from_scanner)) {
        continue;  // the operator's word tells it from the right one
      }
      if (copy == fits.end()) {
        fits.push_back(std::move(fit));
      } else if (copy->score < fit.score) {
        *copy = std::move(fit);
      }
    }
  }
  if (job.cancelled()) {
    scan.reason = "registration was stopped; run it again";
    return false;
  }
  std::stable_sort(fits.begin(), fits.end(),
                   [](const ModelFit& a, const ModelFit& b) { return a.score > b.score; });
  const PoseVerdict verdict = verify_pose(fits, options_.search.verify);
  FoundPose found{std::move(fits), verdict};
  WithoutForeign without_foreign(*this, id, ids);
  if (verdict.status != PoseStatus::kRegistered && !without_foreign.settles(found)) {
    scan.reason = verdict.reason;
    scan.outcome = verdict.status;
    return false;
  }
  without_foreign.keep();
  connect(id, found.fits.front(), false, ids, group);
  scan.hint_reason.clear();
  settle_group(scans_.at(id).group, job);
  judge(id);
  return true;
}

bool ScanModel::join_by_hint(int hinted, JobContext& job) {
  const int hinted_id = stands_as(hinted);
  Scan& scan = scans_.at(hinted_id);
  const PoseHint hint = hint_for(hinted);
  Scan& on = scans_.at(stands_as(hint.on));
  const RigidTransform group_from_on = on.group_from_scanner;
  const int group = on.group;
  const auto in_group = [&](std::vector<RigidTransform> on_from_scanner) {
    for (RigidTransform& pose : on_from_scanner) {
      pose = group_from_on * pose;
    }
    return on_from_scanner;
  };
  const std::vector<RigidTransform> starts =
      in_group(starts_from_hint(hint, *scan.features.surface, *on.features.surface));
  const auto joined = [&](const std::vector<RigidTransform>& from) {
    const bool done = !from.empty() && join_from(hinted_id, group, from, job);
    if (done) {
      on.hint_reason.clear();
    }
    return done;
  };
  if (joined(starts)) {
    return true;
  }
  // One or two clicks beside a crease can give a poor normal: what the surfaces resemble, filtered by them.
  if (hint.points.size() < 3 && !hint.on_from_scanner && !job.cancelled()) {
    std::vector<RigidTransform> found;
    for (const int id : members(group)) {
      for (const PoseHypothesis& h :
           align_pair(scan.features, scans_.at(id).features, options_.search.align)) {
        found.push_back(scans_.at(id).group_from_scanner * h.target_from_source);
      }
    }
    found.insert(found.end(), starts.begin(), starts.end());
    if (joined(found)) {
      return true;
    }
  }
  if (!job.cancelled()) {
    // Whichever of the two is left out says so.
    scan.hint_reason = "the hint leads to no certain pose: " + scan.reason;
    on.hint_reason = scan.hint_reason;
  }
  return false;
}

bool ScanModel::set_hint(int id, const PoseHint& hint) {
  const bool freed = free_hinted(id);
  hints_[id] = hint;
  return freed;
}

bool ScanModel::free_hinted(int id) {
  const auto hint = hints_.find(id);
  if (hint == hints_.end()) {
    return false;
  }
  bool freed = false;
  for (const int either : {id, hint->second.on}) {
    if (const auto scan = scans_.find(stands_as(either));
        scan != scans_.end() && !scan->second.hint_reason.empty()) {
      scan->second.hint_reason.clear();
      scan->second.tried_on.clear();  // by its hint alone
      freed = true;
    }
  }
  return freed;
}

bool ScanModel::free_hints_of(int id) {
  bool freed = false;
  for (const auto& [hinted, hint] : hints_) {
    if (hinted == id || hint.on == id) {
      freed = free_hinted(hinted) || freed;
    }
  }
  return freed;
}

void ScanModel::clear_hint(int id, JobContext& job) {
  free_hinted(id);
  if (hints_.erase(id) > 0) {
    retry(job);
  }
}

bool ScanModel::follow_hint(int id, JobContext& job) {
  const auto found = scans_.find(stands_as(id));
  const auto hint = hints_.find(id);
  if (found == scans_.end() || hint == hints_.end() || !found->second.usable) {
    return false;
  }
  const auto on = scans_.find(stands_as(hint->second.on));
  if (on == scans_.end() || !on->second.usable || on == found) {
    return false;
  }
  Scan& scan = found->second;
  bool apart = false;
  if (scan.group == on->second.group) {
    const RigidTransform now = on->second.group_from_scanner.inverse() * scan.group_from_scanner;
    if (agrees_with(hint_for(id), now, scan.features.surface->centroid_mm)) {
      return true;
    }
    if (scan.is_locked()) {
      return false;
    }
    // It stands in the wrong place: out of its group, and in again where the hint says.
    const int left = scan.group;
    apart = leave(found->first);
    settle_without_one(left, job);
    scan.leads.clear();
  }
  const bool followed = join_group(found->first, on->second.group, job);
  if (followed || apart) {
    retry(job);
  }
  return followed;
}

bool ScanModel::set_locked(int id, bool locked) {
  const auto found = scans_.find(stands_as(id));
  if (found == scans_.end() || !found->second.usable) {
    return false;
  }
  if (locked) {
    found->second.locked_as.insert(id);
  } else if (found->second.locked_as.erase(id) > 0 && !found->second.is_locked()) {
    is_unsettled_ = true;  // nobody has asked yet what but the lock holds it there
  }
  return true;
}

LockOutcome ScanModel::lock_near(int id, const RigidTransform& model_from_id) {
  const RigidTransform model_from_scanner = model_from_id * scan_from(id).inverse();
  const auto found = scans_.find(stands_as(id));
  if (found == scans_.end() || pose(id).status != PoseStatus::kRegistered) {
    return LockOutcome::kNotRegistered;
  }
  Scan& scan = found->second;
  const ScanSurface& surface = *scan.features.surface;
  const RigidTransform off = scan.group_from_scanner * model_from_scanner.inverse();
  const double miss_mm =
      (scan.group_from_scanner * surface.centroid_mm - model_from_scanner * surface.centroid_mm).norm() +
      0.5 * surface.extent_mm * off.angle_rad();
  const bool here = miss_mm <= std::max(kMostLockMissMm, kMostLockMissSpacings * surface.spacing_mm);
  set_locked(id, here);
  return here ? LockOutcome::kLocked : LockOutcome::kElsewhere;
}

bool ScanModel::join_as_given(int id, int group, JobContext& job) {
  Scan& scan = scans_.at(id);
  const std::vector<int> ids = members(group);
  scan.tried_on.insert(ids.begin(), ids.end());
  // Groups keep the frame of the poses that they were given in.
  PoseHints hints;
  hints.told.push_back(scan.group_from_scanner);
  WithoutForeign without_foreign(*this, id, ids);
  const FoundPose found = search_pose(
      *scan.features.surface, model_of(ids), hints, [](std::size_t) { return std::vector<PoseHypothesis>{}; },
      [&](const ModelFit& fit) { return shape_is_distinctive(id, fit, ids); }, options_.search, job,
      [&](FoundPose& refused) { return without_foreign.settles(refused); },
      [&](const ModelFit& fit) { return relief_repeats(id, fit, ids); });
  const bool registered = found.verdict.status == PoseStatus::kRegistered && !job.cancelled();
  // A rival that the given pose called up may fit better: then the given one is wrong, and no word says so.
  const PoseHint given{-1, {}, scan.group_from_scanner};
  if (!registered ||
      !agrees_with(given, found.fits.front().model_from_scanner, scan.features.surface->centroid_mm)) {
    if (measurements(members(scan.group)) == 1) {
      scan.reason = job.cancelled() ? "registration was stopped; run it again"
                    : registered    ? "the pose that was given does not fit; register it without"
                                    : found.verdict.reason;
      scan.outcome = registered ? PoseStatus::kUnsure : found.verdict.status;
    }
    return false;
  }
  without_foreign.keep();
  connect(id, found.fits.front(), false, ids, group);
  settle_group(scans_.at(id).group, job);
  judge(id);
  return true;
}

void ScanModel::enter_at(int id, const RigidTransform& model_from_scanner) {
  Scan& scan = scans_.at(id);
  scan.given = true;
  scan.group_from_scanner = model_from_scanner.orthonormalised();
}

}  // namespace dubsar
