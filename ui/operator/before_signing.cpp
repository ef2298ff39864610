// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What stands in the way of a signature.
#include "ui/operator/before_signing.h"

#include <algorithm>

namespace dubsar::ui {

namespace {

/// "4, 6"; as many as a headline takes.
template <class Is>
std::string numbers_of(const LiveState& state, const Is& is) {
  constexpr int kMostNamed = 8;
  std::string out;
  int named = 0;
  for (const LiveScan& scan : state.scans) {
    if (!is(scan) || named > kMostNamed) {
      continue;
    }
    out += (out.empty() ? "" : ", ") + (named++ == kMostNamed ? "…" : std::to_string(scan.id));
  }
  return out;
}

}  // namespace

int unjudged_scans(const LiveState& state) {
  return static_cast<int>(std::ranges::count_if(
      state.scans, [](const LiveScan& scan) { return !scan.dropped && !scan.damaged && !scan.pose; }));
}

std::string damaged_scans(const LiveState& state) {
  return numbers_of(state, [](const LiveScan& scan) { return scan.damaged && !scan.dropped; });
}

std::string damaged_scans_taken_out(const LiveState& state) {
  return numbers_of(state, [](const LiveScan& scan) { return scan.damaged && scan.dropped; });
}

std::string scans_of_lost_records(const LiveState& state) {
  return numbers_of(state, [](const LiveScan& scan) { return scan.record_lost && !scan.dropped; });
}

std::string scans_without_place(const LiveState& state) {
  return numbers_of(state, [](const LiveScan& scan) {
    return !scan.dropped && !scan.damaged && scan.pose && scan.pose->status != PoseStatus::kRegistered;
  });
}

bool is_damaged(const LiveState& state) {
  return state.damage_found || std::ranges::any_of(state.scans, &LiveScan::damaged);
}

bool is_session_whole(const LiveState& state) {
  return state.checklist && state.checklist->store_whole && !is_damaged(state) &&
         state.lost_records.empty() && scans_of_lost_records(state).empty();
}

SigningReason signing_reason(const LiveState& state) {
  const bool conclusive = state.red_map && state.red_map->conclusive;
  SigningReason out;
  out.wanted = !conclusive || std::ranges::any_of(state.scans, &LiveScan::damaged);
  out.asked = out.wanted || is_damaged(state) || (state.checklist && !state.checklist->store_whole);
  return out;
}

}  // namespace dubsar::ui
