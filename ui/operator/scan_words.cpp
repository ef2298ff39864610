// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is told of a scan alone.
#include <algorithm>

#include "ui/operator/statement.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

std::optional<int> copy_of(const LiveState& state, const LiveScan& scan) {
  const bool counts = !scan.dropped && scan.pose && scan.pose->status == PoseStatus::kRegistered;
  return counts && state.red_map ? copied_from(state.red_map->copies, scan.id) : std::nullopt;
}

const LiveScan* newest_standing(const LiveState& state) {
  const auto last = std::ranges::find_if(state.scans.rbegin(), state.scans.rend(),
                                         [](const LiveScan& scan) { return !scan.dropped; });
  return last == state.scans.rend() ? nullptr : &*last;
}

std::string scan_warning(const LiveScan& scan, Language language) {
  if (scan.dropped || !scan.pose || scan.pose->status != PoseStatus::kRegistered ||
      scan.pose->warning.empty()) {
    return {};
  }
  return filled(text_of(Text::kScanSays, language), scan.id, translated(scan.pose->warning, language));
}

std::string place_words(const LiveScan& scan, Language language) {
  const bool is_known = scan.pose && scan.pose->status == PoseStatus::kRegistered && scan.pose->sigma_mm > 0;
  return is_known ? filled(text_of(Text::kUncertainty, language), 1000 * scan.pose->sigma_mm) : std::string();
}

}  // namespace dubsar::ui
