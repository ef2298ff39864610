// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How a scan is found during which something moved, or whose lengths are not those of the others.
#include <algorithm>

#include "core/log.h"
#include "core/parallel.h"
#include "registration/scan_model.h"
#include "registration/scan_motion.h"
#include "registration/scan_stretch.h"

namespace dubsar {

void ScanModel::put_out_faulty(JobContext& job) {
  std::set<int> candidates;
  candidates.swap(unchecked_);
  while (true) {
    if (job.cancelled()) {
      unchecked_.merge(candidates);  // for the next time
      return;
    }
    std::optional<Fault> worst;
    int worst_id = -1;
    for (const int id : candidates) {
      const std::optional<Fault> fault = fault_of(id);
      if (fault && (!worst || fault->gained > worst->gained)) {
        worst = fault;
        worst_id = id;
      }
    }
    if (!worst) {
      return;
    }
    candidates.erase(worst_id);
    Scan& scan = scans_.at(worst_id);
    const int group = scan.group;
    const bool apart = leave(worst_id);
    const std::vector<int> rest = members(group);
    scan.fault_reason = worst->reason;
    scan.has_moved = true;
    if (rest.size() == 1) {
      scan.fault_reason +=
          "; or that is wrong with " + name_of(rest.front()) + ", the only one that it was compared with";
    }
    scan.outcome = PoseStatus::kUnsure;
    scan.leads.clear();
    // Tried again when there is a scan that it has not met: the other one may be the one that moved.
    for (const auto& [other, unused] : scans_) {
      scan.tried_on.insert(other);
    }
    settle_group(group, job);
    for (const int other : rest) {
      judge(other);
    }
    if (apart) {
      retry(job);
      candidates.merge(unchecked_);
      unchecked_.clear();
      candidates.erase(worst_id);
    }
  }
}

std::optional<ScanModel::Fault> ScanModel::fault_of(int id) {
  const auto found = scans_.find(id);
  if (found == scans_.end() || !found->second.usable || found->second.is_locked()) {
    return std::nullopt;
  }
  const std::optional<InGroup> placed = in_group(id);
  if (!placed) {
    return std::nullopt;
  }
  const auto& [scan, others, fit] = *placed;
  const ScanSurface& surface = *scan.surface;
  const std::vector<ModelScan> model = model_scans(others);
  const std::optional<ScanMotion> motion =
      find_motion(surface, model, fit, options_.search.fit, found->second.has_moved);
  if (!motion) {
    found->second.has_moved = false;
    return std::nullopt;
  }
  // Bands of another tablet lie each where they fit best, too.
  const std::string or_another = sure(fit, options_.search.verify) ? "" : "; or it is of another tablet";
  // Rows that drift apart one by one look as if something had moved, too.
  const std::optional<ScanStretch> stretch = find_stretch(surface, model, fit);
  if (stretch && stretch->is_off()) {
    ModelFit mended = fit;
    mended.model_from_scanner = stretch->model_from_mended;
    if (!find_motion(*stretch->mended, model, mended, options_.search.fit)) {
      return Fault{motion->gained, reason_of(*stretch) + or_another};
    }
  }
  return Fault{motion->gained, reason_of(*motion) + or_another};
}

void ScanModel::warn_of_stretched() {
  for (auto& [id, scan] : scans_) {
    scan.warning.clear();
  }
  const std::vector<int> ids = members(main_group());
  parallel_for_each_index(
      ids.size(),
      [&](std::size_t k) {
        const std::optional<InGroup> placed = in_group(ids[k]);
        if (!placed) {
          return;
        }
        const ScanSurface& surface = *placed->scan.surface;
        const std::vector<ModelScan> model = model_scans(placed->others);
        const ModelFit& fit = placed->fit;
        if (!may_be_stretched(surface, model, fit)) {
          return;
        }
        const std::optional<ScanStretch> stretch = find_stretch(surface, model, fit);
        if (stretch && stretch->is_off()) {
          scans_.at(ids[k]).warning = reason_of(*stretch);
        }
      },
      1);
  for (const int id : ids) {
    if (const std::string& warning = scans_.at(id).warning; !warning.empty()) {
      log_warning(name_of(id) + ": " + warning);
    }
  }
}

std::string ScanModel::name_of(int id) const {
  const std::string& file = scans_.at(id).file;
  return file.empty() ? "scan " + std::to_string(id) : file;
}

}  // namespace dubsar
