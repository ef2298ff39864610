// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>

#include "ui/operator/statement.h"

namespace dubsar::ui::testing {

/// A session with scan 4 of that status alone.
inline LiveState with_scan(PoseStatus status) {
  LiveState state;
  LiveScan scan;
  scan.id = 4;
  scan.pose = ScanPose{};
  scan.pose->id = 4;
  scan.pose->status = status;
  scan.pose->reason = "the overlap is too small";
  state.scans.push_back(scan);
  return state;
}

/// Conclusive, or with so many mm² of red on the left side.
inline std::shared_ptr<const RedMap> map_with(double red) {
  auto map = std::make_shared<RedMap>();
  map->conclusive = red <= 0;
  if (red > 0) {
    RedRegion region;
    region.face = Face::kLeft;
    region.area_mm2 = red;
    map->regions.push_back(region);
  }
  return map;
}

}  // namespace dubsar::ui::testing
