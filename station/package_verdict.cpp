// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The verdict of a package in a sentence, for who opens it and for catalogues that take its label.

#include "archive/html.h"
#include "core/checklist.h"
#include "station/package_content.h"

namespace dubsar {

std::string conclusive_words(const RedMap& map) {
  const RegionSum hidden = sum_out_of_reach(map);
  const std::string words = "every part of the tablet that the scanner can reach is sampled densely enough.";
  return hidden.count == 0
             ? words
             : words + " " + counted(hidden.count, "place is", "places are") + " out of its reach, " +
                   fixed(hidden.area_mm2, hidden.area_mm2 < 10 ? 2 : 1) +
                   " mm² by estimate: there the shape is not recorded, and the report lists where.";
}

}  // namespace dubsar
