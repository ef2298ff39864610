// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How a scan leaves a model: what only it connected leaves with it.
#include <algorithm>

#include "core/disjoint_sets.h"
#include "registration/scan_model.h"

namespace dubsar {

namespace {

constexpr const char* kConnectionGone =
    "the scan that connected it was taken out; scan what connects it, with at least 30 % overlap";

}  // namespace

bool ScanModel::remove(int id, JobContext& job) {
  scan_from_.erase(id);
  kept_poses_.erase(id);
  if (leaves_a_copy(id)) {
    return true;
  }
  if (!scans_.contains(id)) {
    return false;
  }
  const int group = scans_.at(id).group;
  const bool apart = leave(id);
  scans_.erase(id);
  settle_without_one(group, job);
  std::erase_if(parts_, [id](const auto& e) { return e.first.first == id || e.first.second == id; });
  bool accused = false;
  for (auto& [other, scan] : scans_) {
    scan.tried_on.erase(id);
    std::erase_if(scan.leads, [&](const Lead& lead) { return lead.on == id; });
    if (!scan.fault_reason.empty()) {
      // What contradicted it may have been the one that is gone.
      scan.fault_reason.clear();
      scan.has_moved = false;
      scan.tried_on.clear();
      accused = true;
    }
  }
  if (apart || accused) {
    retry(job);
  }
  return true;
}

void ScanModel::settle_without_one(int group, JobContext& job) {
  const std::vector<int> rest = members(group);
  if (measurements(rest) > 1) {
    is_unsettled_ = true;
    return;
  }
  settle_group(group, job);
  for (const int id : rest) {
    judge(id);
  }
}

bool ScanModel::leave(int id) {
  Scan& scan = scans_.at(id);
  const int group = scan.group;
  for (const int member : members(group)) {
    make_whole(member);  // what was left out followed from where all of them were
  }
  scan.group = next_group_++;
  scan.covariance.setZero();
  std::erase_if(pairs_, [&](const auto& e) { return e.first.first == id || e.first.second == id; });
  std::vector<std::vector<int>> pieces = pieces_of(group);
  if (pieces.size() < 2) {
    return false;
  }
  // Groups that were joined by one scan may overlap in others, which nobody measured as long as they held.
  measure_between(pieces);
  pieces = pieces_of(group);
  is_unsettled_ = true;
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    const int own = next_group_++;
    if (pieces[k].size() == 1) {
      scans_.at(pieces[k].front()).covariance.setZero();
    }
    for (const int member : pieces[k]) {
      Scan& apart = scans_.at(member);
      apart.group = own;
      apart.reason = kConnectionGone;
      apart.fault_reason.clear();
      apart.outcome = PoseStatus::kUnsure;
      apart.tried_on.clear();
      // Where it stood may be right still, but has to be verified without the scan that spoke for it.
      const int on = pieces.front().front();
      apart.leads.assign(1, {on, scans_.at(on).group_from_scanner.inverse() * apart.group_from_scanner});
    }
  }
  return pieces.size() > 1;
}

std::vector<std::vector<int>> ScanModel::pieces_of(int group) const {
  const std::vector<int> ids = members(group);
  DisjointSets sets(ids.size());
  const auto place = [&](int id) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(ids, id) - ids.begin());
  };
  for (const auto& [key, pair] : pairs_) {
    if (std::ranges::binary_search(ids, key.first) && std::ranges::binary_search(ids, key.second)) {
      sets.unite(place(key.first), place(key.second));
    }
  }
  // The stage speaks for the scans of one placement, the operator for those that are locked.
  std::map<int, int> first_of_placement;
  std::optional<int> first_locked;
  for (const int id : ids) {
    const Scan& scan = scans_.at(id);
    if (scan.nominal) {
      sets.unite(place(id), place(first_of_placement.try_emplace(scan.nominal->placement, id).first->second));
    }
    if (scan.is_locked()) {
      first_locked = first_locked.value_or(id);
      sets.unite(place(id), place(*first_locked));
    }
  }
  std::map<std::uint32_t, std::vector<int>> by_root;
  for (std::uint32_t k = 0; k < ids.size(); ++k) {
    by_root[sets.root(k)].push_back(ids[k]);
  }
  std::vector<std::vector<int>> pieces;
  pieces.reserve(by_root.size());
  for (auto& [root, piece] : by_root) {
    pieces.push_back(std::move(piece));
  }
  std::ranges::stable_sort(pieces, std::ranges::greater{},
                           [&](const std::vector<int>& piece) { return measurements(piece); });
  // What the operator fixed lies in the frame of the largest piece, connected or not.
  const auto locked = std::ranges::find_if(pieces, [&](const std::vector<int>& piece) {
    return std::ranges::any_of(piece, [&](int id) { return scans_.at(id).is_locked(); });
  });
  if (locked != pieces.end() && locked != pieces.begin()) {
    pieces.front().insert(pieces.front().end(), locked->begin(), locked->end());
    std::ranges::sort(pieces.front());
    pieces.erase(locked);
  }
  return pieces;
}

void ScanModel::measure_between(const std::vector<std::vector<int>>& pieces) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    std::vector<int> before;
    for (std::size_t other = 0; other < k; ++other) {
      before.insert(before.end(), pieces[other].begin(), pieces[other].end());
    }
    for (const int id : pieces[k]) {
      const Scan& scan = scans_.at(id);
      for (const std::size_t touching : judge_in_model(*scan.features.surface, model_of(before),
                                                       scan.group_from_scanner, options_.search.fit)
                                            .touching) {
        pairs.push_back(std::minmax(id, before[touching]));
      }
    }
  }
  measure_pairs(pairs);
}

}  // namespace dubsar
