// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How a scan is found during which something moved, and leaves the model.
#include <algorithm>

#include "registration/scan_model.h"
#include "registration/scan_motion.h"

namespace dubsar {

void ScanModel::put_out_moved(JobContext& job) {
  std::set<int> candidates;
  candidates.swap(unchecked_);
  while (true) {
    if (job.cancelled()) {
      unchecked_.merge(candidates);  // for the next time
      return;
    }
    std::optional<ScanMotion> worst;
    int worst_id = -1;
    for (const int id : candidates) {
      const std::optional<ScanMotion> motion = motion_of(id);
      if (motion && (!worst || motion->gained > worst->gained)) {
        worst = motion;
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
    scan.motion_reason = reason_of(*worst);
    if (rest.size() == 1) {
      const std::string& file = scans_.at(rest.front()).file;
      scan.motion_reason += "; or it happened during " +
                            (file.empty() ? "scan " + std::to_string(rest.front()) : file) +
                            ", the only one that it was compared with";
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

std::optional<ScanMotion> ScanModel::motion_of(int id) const {
  const auto found = scans_.find(id);
  if (found == scans_.end() || !found->second.usable || found->second.locked) {
    return std::nullopt;
  }
  const Scan& scan = found->second;
  std::vector<int> others = members(scan.group);
  std::erase(others, id);
  if (others.empty()) {
    return std::nullopt;
  }
  const std::vector<ModelScan> model = model_of(others);
  const ModelFit fit =
      judge_in_model(*scan.features.surface, model, scan.group_from_scanner, options_.search.fit);
  return find_motion(*scan.features.surface, model, fit, options_.search.fit);
}

}  // namespace dubsar
