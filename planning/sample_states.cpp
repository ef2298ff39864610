// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/sample_states.h"

#include <map>

namespace dubsar {

namespace {

SampleState state_of(std::uint8_t flags) {
  if ((flags & kNotTablet) != 0) {
    return SampleState::kNone;
  }
  if (is_red(flags)) {
    return SampleState::kRed;
  }
  // What another scan has sampled well needs no excuse.
  if ((flags & kSparse) != 0 && (flags & kCleared) != 0) {
    return SampleState::kCleared;
  }
  return (flags & kExcused) != 0 ? SampleState::kUnreachable : SampleState::kSampled;
}

SampleState state_of(const RedTarget& target) {
  if (is_stray(target)) {
    return SampleState::kStray;
  }
  return target.excuse == Excuse::kUnneeded ? SampleState::kInterpolated : SampleState::kUnreachable;
}

}  // namespace

bool is_stray(const RedTarget& target) {
  return target.state == RegionState::kExcused && !target.unseen && !(target.area_mm2 > 0);
}

SampleStates sample_states(const RangeGrid& grid, const SampleFlags& flags,
                           const std::vector<int>& cleared_by, const RedTargets& red,
                           std::uint32_t position) {
  SampleStates out;
  out.state.assign(grid.size(), SampleState::kNone);
  out.cleared_by.assign(grid.size(), -1);
  out.reason.assign(grid.size(), -1);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] == 0) {
      continue;
    }
    out.state[i] = state_of(flags[i]);
    if (out.state[i] == SampleState::kCleared && i < cleared_by.size()) {
      out.cleared_by[i] = cleared_by[i];
    }
  }
  std::map<std::string, int> known;
  for (const RedSampleRef& ref : red.samples) {
    const RedTarget& target = red.targets[ref.target];
    if (ref.scan != position || target.state != RegionState::kExcused) {
      continue;
    }
    const auto [at, is_new] = known.emplace(target.reason, static_cast<int>(out.reasons.size()));
    if (is_new) {
      out.reasons.push_back(target.reason);
    }
    out.state[ref.sample] = state_of(target);
    out.reason[ref.sample] = at->second;
  }
  return out;
}

}  // namespace dubsar
