// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "archive/report.h"
#include "archive/six_views.h"

namespace dubsar {

/// One place of the red map, seen from where it looks to, a ring round it.
struct RegionPicture {
  std::size_t region = 0;      ///< position in RedMap::regions
  Face side = Face::kObverse;  ///< whose picture shows it: that of the region's face
  Image image;
  std::string uri;  ///< the image as a data URI
};

/// All that report, checklist and picture files show, drawn once.
struct ReportPictures {
  bool empty = true;  ///< there is no surface: nothing was drawn
  SixViews sides;
  Image sides_sheet;
  Image red_sheet;  ///< with the numbers of the pictured places
  Image red_page;   ///< the same, half as large
  std::string red_page_uri;
  std::vector<RegionPicture> regions;  ///< red ones first, then the largest
};

/// Places that get a picture of their own; the rest stand in the table.
inline constexpr std::size_t kMostRegionPictures = 24;

/// What goes onto both pages is encoded here, once. Errors: a picture that cannot be drawn, cancelled.
[[nodiscard]] Result<ReportPictures> draw_pictures(const ReportInput& input, const JobContext& job);

/// Positions in map.regions of what a person has to look at: red ones first, then by size; strays are left
/// out.
[[nodiscard]] std::vector<std::size_t> regions_by_weight(const RedMap& map);

/// The number of a place as people read it: its position in the red map, counted from 1.
[[nodiscard]] inline std::size_t region_number(std::size_t position) {
  return position + 1;
}

/// Half as wide and high, for a page that would be heavy otherwise.
[[nodiscard]] Image halved(const Image& image);

}  // namespace dubsar
