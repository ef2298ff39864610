// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "planning/point_cells.h"

namespace dubsar {

namespace {

/// What is out of reach is told by its reason: which side no pose sees, and which one was looked at in vain.
bool alike(const RedTarget& a, const RedTarget& b) {
  return a.state == b.state && a.excuse == b.excuse &&
         (a.state != RegionState::kExcused || a.excuse != Excuse::kUnreachable || a.reason == b.reason);
}

void join_near(const RedTargets& red, std::span<const std::uint32_t> members, double radius_mm,
               double at_least_mm, UnionFind& sets) {
  PointCells cells(std::max(radius_mm, at_least_mm));
  for (const std::uint32_t i : members) {
    cells.add(red.targets[i].position_mm, i);
  }
  for (const std::uint32_t i : members) {
    cells.for_each_within(red.targets[i].position_mm, [&](std::uint32_t j) {
      const RedTarget& a = red.targets[i];
      const RedTarget& b = red.targets[j];
      if (j <= i || !alike(a, b)) {
        return;
      }
      const double near_mm = std::max(at_least_mm, radius_mm * std::max(a.cell_share, b.cell_share));
      if ((a.position_mm - b.position_mm).squaredNorm() <= near_mm * near_mm) {
        sets.join(i, j);
      }
    });
  }
}

void join_along_grids(const RedTargets& red, std::span<const PlacedScan> scans, double reach_mm,
                      UnionFind& sets) {
  std::vector<RedSampleRef> refs = red.samples;
  std::sort(refs.begin(), refs.end(), [](const RedSampleRef& a, const RedSampleRef& b) {
    return std::tie(a.scan, a.sample) < std::tie(b.scan, b.sample);
  });
  const auto join = [&](const RedSampleRef& a, const RedSampleRef& b) {
    const RedTarget& ta = red.targets[a.target];
    const RedTarget& tb = red.targets[b.target];
    if (a.target != b.target && alike(ta, tb) && (ta.position_mm - tb.position_mm).norm() <= reach_mm) {
      sets.join(a.target, b.target);
    }
  };
  std::array<std::size_t, 4> ahead{};  // walks in step with i, one per kind of neighbour
  for (std::size_t i = 0; i < refs.size(); ++i) {
    const auto cols = static_cast<std::int64_t>(scans[refs[i].scan].grid->cols);
    const std::array<std::int64_t, 4> steps = {1, cols - 1, cols, cols + 1};
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const auto wanted = std::pair<std::int64_t, std::int64_t>(refs[i].scan, refs[i].sample + steps[k]);
      ahead[k] = std::max(ahead[k], i + 1);
      while (ahead[k] < refs.size() &&
             std::pair<std::int64_t, std::int64_t>(refs[ahead[k]].scan, refs[ahead[k]].sample) < wanted) {
        ++ahead[k];
      }
      if (ahead[k] < refs.size() && refs[ahead[k]].scan == refs[i].scan &&
          refs[ahead[k]].sample == wanted.second) {
        join(refs[i], refs[ahead[k]]);
      }
    }
  }
}

}  // namespace

UnionFind::UnionFind(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0U);
}

std::uint32_t UnionFind::find(std::uint32_t i) {
  while (parent_[i] != i) {
    parent_[i] = parent_[parent_[i]];
    i = parent_[i];
  }
  return i;
}

void UnionFind::join(std::uint32_t a, std::uint32_t b) {
  a = find(a);
  b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

std::vector<std::vector<std::uint32_t>> UnionFind::groups() {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_root;
  for (std::uint32_t i = 0; i < parent_.size(); ++i) {
    by_root[find(i)].push_back(i);
  }
  std::vector<std::vector<std::uint32_t>> out;
  for (auto& [root, group] : by_root) {
    out.push_back(std::move(group));
  }
  return out;
}

std::vector<std::vector<std::uint32_t>> cluster_targets(const RedTargets& red,
                                                        std::span<const PlacedScan> scans, double radius_mm,
                                                        double grid_reach_mm, bool unseen_too,
                                                        double at_least_mm) {
  std::vector<std::uint32_t> members;
  for (std::uint32_t i = 0; i < red.targets.size(); ++i) {
    if (unseen_too || !red.targets[i].unseen) {
      members.push_back(i);
    }
  }
  UnionFind sets(red.targets.size());
  join_near(red, members, radius_mm, at_least_mm, sets);
  join_along_grids(red, scans, grid_reach_mm, sets);
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
  for (const std::uint32_t i : members) {
    groups[sets.find(i)].push_back(i);
  }
  std::vector<std::vector<std::uint32_t>> out;
  out.reserve(groups.size());
  for (auto& [root, group] : groups) {
    out.push_back(std::move(group));
  }
  return out;
}

}  // namespace dubsar
