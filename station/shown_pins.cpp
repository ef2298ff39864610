// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/shown_pins.h"

#include <algorithm>

namespace dubsar {

std::string pin_name(int label) {
  return is_rim_label(label) ? std::string(1, static_cast<char>('A' + label - kFirstRimLabel))
                             : std::to_string(label);
}

std::vector<ShownPin> shown_pins(const PinSet& pins, const std::vector<ScanPose>& poses, double same_mm) {
  std::vector<ShownPin> out;
  for (const auto& [id, tips] : pins.tips) {
    const auto pose = std::ranges::find(poses, id, &ScanPose::id);
    if (pose == poses.end() || pose->status != PoseStatus::kRegistered) {
      continue;
    }
    for (const PinTip& tip : tips) {
      const Eigen::Vector3d at = pose->model_from_scanner * tip.position_mm;
      if (tip.label < 0 || !at.allFinite()) {
        continue;
      }
      const auto same = std::ranges::find_if(out, [&](const ShownPin& known) {
        return known.label == tip.label && (known.position_mm - at).norm() <= same_mm;
      });
      if (same == out.end()) {
        out.push_back({tip.label, at, {id}});
        continue;
      }
      const auto before = static_cast<double>(same->scans.size());
      same->position_mm = (before * same->position_mm + at) / (before + 1);
      same->scans.push_back(id);
    }
  }
  std::ranges::stable_sort(out, {}, &ShownPin::label);
  return out;
}

}  // namespace dubsar
