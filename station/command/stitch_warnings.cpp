// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/stitch_warnings.h"

#include <fmt/format.h>

#include <set>
#include <vector>

#include "core/log.h"

namespace dubsar {

void warn_of_places(const Stitcher& stitcher, const std::map<int, std::string>& names) {
  std::set<int> touching;
  const std::vector<Stitcher::Overlap> overlaps = stitcher.overlaps();
  for (const Stitcher::Overlap& overlap : overlaps) {
    touching.insert(overlap.id);
    touching.insert(overlap.other_id);
  }
  // A scan that touches no other lies wrong, or alone; the mesh shows it beside the rest.
  for (const auto& [id, name] : names) {
    if (names.size() > 1 && !touching.contains(id)) {
      log_warning(name + " overlaps no other scan where its pose puts it; look whether that pose is right");
    }
  }
  for (const Stitcher::Overlap& overlap : overlaps) {
    if (overlap.is_off()) {
      log_warning(fmt::format(
          "scans {} and {} lie {:.2f} mm apart where they overlap, more than noise explains; the "
          "mesh is less reliable, and may have a scan where the others fit it, not where its pose "
          "puts it; register them again",
          overlap.id, overlap.other_id, overlap.step_mm));
    }
  }
}

}  // namespace dubsar
