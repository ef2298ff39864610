// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The pairs between the scans of a group and their relaxation: the other half of ScanModel.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/log.h"
#include "core/parallel.h"
#include "registration/pair_fit.h"
#include "registration/scan_model.h"

namespace dubsar {

namespace {

/// A pair whose scans have moved by less than this many residual sigmas since would be measured alike.
constexpr double kFreshSigmas = 0.5;

}  // namespace

std::optional<ScanModel::Pair> ScanModel::measured_pair(int a, int b) const {
  const ScanSurface& on = *scans_.at(a).features.surface;
  const ScanSurface& moved = *scans_.at(b).features.surface;
  const RigidTransform start = scans_.at(a).group_from_scanner.inverse() * scans_.at(b).group_from_scanner;
  const std::optional<PairFit> fit =
      fit_pair(on, moved, start, residual_sigma_mm(on, moved, options_.search.fit));
  if (!fit) {
    return std::nullopt;
  }
  Pair pair;
  pair.measured_from = start;
  pair.a_from_b = fit->on_from_moved;
  pair.center_mm = fit->center_mm;
  pair.information = fit->information;
  pair.of_a = fit->of_on;
  pair.of_b = fit->of_moved;
  return pair;
}

void ScanModel::measure_pairs(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<std::optional<Pair>> measured(pairs.size());
  parallel_for_each_index(
      pairs.size(), [&](std::size_t k) { measured[k] = measured_pair(pairs[k].first, pairs[k].second); }, 1);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs_.erase(pairs[k]);
    if (measured[k]) {
      pairs_[pairs[k]] = *measured[k];
    }
  }
}

bool ScanModel::pair_is_fresh(int a, int b) const {
  const auto pair = pairs_.find({a, b});
  if (pair == pairs_.end()) {
    return false;
  }
  const ScanSurface& on = *scans_.at(a).features.surface;
  const ScanSurface& moved = *scans_.at(b).features.surface;
  const RigidTransform now = scans_.at(a).group_from_scanner.inverse() * scans_.at(b).group_from_scanner;
  const double sigma_mm = residual_sigma_mm(on, moved, options_.search.fit);
  const double most_mm = kFreshSigmas * sigma_mm;
  return same_pose(now, pair->second.measured_from, moved.centroid_mm,
                   most_mm / std::max(moved.extent_mm, 1e-6), most_mm);
}

Status ScanModel::relax_group(int group, const JobContext& job) {
  const std::vector<int> all = members(group);
  std::vector<int> ids = all;
  std::erase_if(ids, [&](int id) { return whole_among(all, id).has_value(); });
  if (ids.size() < 2) {
    for (const int id : ids) {
      scans_.at(id).covariance.setZero();  // by itself it is the frame
    }
    place_parts(all);
    return {};
  }
  std::map<int, std::size_t> place;
  std::vector<RigidTransform> start;
  std::vector<bool> fixed;
  std::vector<Eigen::Vector3d> centers;
  for (const int id : ids) {
    const Scan& scan = scans_.at(id);
    place[id] = start.size();
    start.push_back(scan.group_from_scanner);
    fixed.push_back(scan.is_locked());
    centers.push_back(scan.features.surface->centroid_mm);
  }
  std::vector<PairConstraint> constraints;
  for (const auto& [key, pair] : pairs_) {
    if (place.contains(key.first) && place.contains(key.second)) {
      constraints.push_back({place[key.first], place[key.second], pair.a_from_b, pair.center_mm,
                             pair.information, true, pair.of_a, pair.of_b});
    }
  }
  // What the stage says of scans of one placement: each against the first of its placement.
  std::map<int, int> first_of_placement;
  for (const int id : ids) {
    const Scan& scan = scans_.at(id);
    if (!scan.nominal) {
      continue;
    }
    const auto [first, is_first] = first_of_placement.try_emplace(scan.nominal->placement, id);
    if (is_first) {
      continue;
    }
    const NominalPose& base = *scans_.at(first->second).nominal;
    PairConstraint stage;
    stage.from_surfaces = false;
    stage.a = place[first->second];
    stage.b = place[id];
    stage.a_from_b =
        (base.tablet_from_scanner.inverse() * scan.nominal->tablet_from_scanner).orthonormalised();
    stage.center_mm = stage.a_from_b * scan.features.surface->centroid_mm;
    const double mm = std::max(1e-4, std::hypot(base.sigma_mm, scan.nominal->sigma_mm));
    const double rad = std::max(1e-6, std::hypot(base.sigma_rad, scan.nominal->sigma_rad));
    stage.information.diagonal() << Eigen::Vector3d::Constant(1.0 / (rad * rad)),
        Eigen::Vector3d::Constant(1.0 / (mm * mm));
    constraints.push_back(stage);
  }
  const Result<std::vector<RelaxedPose>> relaxed =
      relax(start, fixed, centers, constraints, options_.relaxation, job);
  if (!relaxed) {
    return std::unexpected(relaxed.error());
  }
  for (const int id : ids) {
    Scan& scan = scans_.at(id);
    scan.group_from_scanner = (*relaxed)[place[id]].model_from_scanner;
    scan.covariance = (*relaxed)[place[id]].covariance;
  }
  place_parts(all);
  return {};
}

void ScanModel::settle_group(int group, const JobContext& job) {
  const Status relaxed = relax_group(group, job);
  is_unsettled_ = is_unsettled_ || (!relaxed && relaxed.error().kind == ErrorKind::kCancelled);
  if (!relaxed && relaxed.error().kind != ErrorKind::kCancelled) {
    log_warning(relaxed.error().line() + "; the poses stay as the fits left them");
  }
}

std::optional<ScanModel::InGroup> ScanModel::in_group(int id) {
  Scan& scan = scans_.at(id);
  std::vector<PlacedSurface> others;
  for (const int other : heard_of(members(scan.group), id)) {
    others.push_back({scans_.at(other).features.surface, scans_.at(other).group_from_scanner});
  }
  if (others.empty()) {
    return std::nullopt;
  }
  const PlacedSurface placed{scan.features.surface, scan.group_from_scanner};
  ModelFit fit = scan.judgement.of(placed, others, options_.search.fit);
  return InGroup{placed, std::move(others), std::move(fit)};
}

void ScanModel::judge(int id) {
  const std::optional<InGroup> placed = in_group(id);
  Scan& scan = scans_.at(id);
  if (!placed) {
    scan.rms_mm = 0;
    scan.overlap = 0;
    return;
  }
  const PoseEvidence both = placed->fit.both();
  scan.rms_mm = both.close > 0 ? std::sqrt(both.sum_r2_mm2 / both.close) : 0.0;
  scan.overlap = std::max(placed->fit.overlap, placed->fit.best_pair_overlap);
}

Status ScanModel::finalize(JobContext& job) {
  bool grown = false;
  for (auto& [id, scan] : scans_) {
    if (scan.usable && scan.group != main_group()) {
      grown = join_group(id, main_group(), job) || grown;
    }
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "registration was stopped");
    }
  }
  if (grown) {
    retry(job);  // those before the one that joined
  }
  const int group = main_group();
  const std::vector<int> ids = members(group);
  for (int round = 0; round < options_.final_rounds && ids.size() > 1; ++round) {
    std::vector<std::pair<int, int>> moved;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      job.progress("relax",
                   (static_cast<double>(round) + static_cast<double>(k) / static_cast<double>(ids.size())) /
                       options_.final_rounds);
      if (job.cancelled()) {
        return fail(ErrorKind::kCancelled, "registration was stopped");
      }
      const std::vector<int> later(ids.begin() + static_cast<std::ptrdiff_t>(k) + 1, ids.end());
      const Scan& scan = scans_.at(ids[k]);
      const ModelFit fit = judge_in_model(*scan.features.surface, model_of(later), scan.group_from_scanner,
                                          options_.search.fit);
      for (const std::size_t touching : fit.touching) {
        if (!pair_is_fresh(ids[k], later[touching])) {
          moved.emplace_back(ids[k], later[touching]);
        }
      }
    }
    if (moved.empty() && !is_unsettled_) {
      break;
    }
    measure_pairs(moved);
    if (const Status relaxed = relax_group(group, job); !relaxed) {
      return relaxed;
    }
    is_unsettled_ = false;
  }
  for (const int id : ids) {
    judge(id);
  }
  job.progress("relax", 1.0);
  job.progress("checking scans", 0.0);
  unchecked_.insert(ids.begin(), ids.end());
  put_out_faulty(job);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "registration was stopped");
  }
  warn();
  job.progress("checking scans", 1.0);
  return {};
}

}  // namespace dubsar
