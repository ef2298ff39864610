// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The verdict of a package in a sentence, for who opens it and for catalogues that take its label.

#include <cmath>

#include "archive/html.h"
#include "core/checklist.h"
#include "station/package_content.h"

namespace dubsar {

std::string conclusive_words(const RedMap& map) {
  long long count = 0;
  double area_mm2 = 0;
  for (const RedRegion& region : map.regions) {
    if (region.state == RegionState::kExcused && region.excuse == Excuse::kUnreachable && !is_stray(region)) {
      ++count;
      area_mm2 += std::isfinite(region.area_mm2) ? region.area_mm2 : 0.0;
    }
  }
  const std::string words = "every part of the tablet that the scanner can reach is sampled densely enough.";
  return count == 0 ? words
                    : words + " " + counted(count, "place is", "places are") + " out of its reach, " +
                          fixed(area_mm2, area_mm2 < 10 ? 2 : 1) +
                          " mm² by estimate: there the shape is not recorded, and the report lists where.";
}

}  // namespace dubsar
