// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "archive/page_blocks.h"
#include "archive/pdf_sheet.h"

namespace dubsar {

/// How large the six sides of a tablet come out on paper, laid out as a cross.
struct CrossPlan {
  static constexpr double kGapMm = 3;  ///< between the sides, of the tablet's own millimetres
  double column_mm = 0;                ///< width of the column of top edge, obverse, bottom edge, reverse
  double middle_mm = 0;                ///< height of the row of the obverse
  double all_wide_mm = 0;
  double all_high_mm = 0;
  double unit = 1;  ///< points to a millimetre of the tablet: life size where there is room
};

[[nodiscard]] inline double height_mm(const PageFigure& figure) {
  return figure.width_mm * figure.height_px / std::max(1, figure.width_px);
}

/// six: top, left, obverse, right, bottom, reverse. room_mm: width of the page between its margins.
[[nodiscard]] inline CrossPlan cross_plan(const std::vector<PageFigure>& six, double room_mm) {
  constexpr double kHighestMm = 235;  // a page, less a heading
  CrossPlan plan;
  plan.column_mm = std::max({six.at(0).width_mm, six.at(2).width_mm, six.at(4).width_mm, six.at(5).width_mm});
  plan.middle_mm = std::max({height_mm(six[1]), height_mm(six[2]), height_mm(six[3])});
  plan.all_wide_mm = six[1].width_mm + plan.column_mm + six[3].width_mm + 2 * CrossPlan::kGapMm;
  plan.all_high_mm =
      height_mm(six[0]) + plan.middle_mm + height_mm(six[4]) + height_mm(six[5]) + 3 * CrossPlan::kGapMm;
  const double fits = std::min(
      {1.0, room_mm / std::max(plan.all_wide_mm, 1e-3), kHighestMm / std::max(plan.all_high_mm, 1e-3)});
  // A whole percentage, so that it can be told; of what would have none, as small as it has to be.
  const double percent = std::floor(100 * fits);
  plan.unit = kPointsPerMm * (percent >= 1 ? percent / 100 : fits);
  return plan;
}

}  // namespace dubsar
