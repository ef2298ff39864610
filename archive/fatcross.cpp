// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/fatcross.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "archive/ruler.h"
#include "archive/scale_bar.h"

namespace dubsar {

namespace {

constexpr double kEblGapMm = 100 * 25.4 / 600;

/// Where everything comes to lie; pixels right and down.
struct Plan {
  int width = 0;
  int height = 0;
  std::array<Eigen::Vector2i, kFaceCount> corners{};  ///< upper left, by Face
  Ruler ruler;
  Eigen::Vector2i ruler_corner{0, 0};
};

Plan plan_of(const SixViews& views, FatcrossKind kind) {
  const bool cdli = kind == FatcrossKind::kCdli;
  const std::array<Face, 4> column =
      cdli ? std::array{Face::kTop, Face::kObverse, Face::kBottom, Face::kReverse}
           : std::array{Face::kObverse, Face::kBottom, Face::kReverse, Face::kTop};
  const double mm_per_px = views[Face::kObverse].mm_per_px;
  const int gap = cdli || !(mm_per_px > 0) ? 0 : static_cast<int>(std::lround(kEblGapMm / mm_per_px));
  const Image& left = views[Face::kLeft];
  const Image& right = views[Face::kRight];
  int wide = 0;
  int high = 0;
  for (const Face face : column) {
    wide = std::max(wide, views[face].width);
    // The edges beside the obverse may stand higher than it does.
    high += face == Face::kObverse ? std::max({views[face].height, left.height, right.height})
                                   : views[face].height;
    high += gap;
  }
  Plan plan;
  // CDLI has no place for a ruler in the column: it lies in the free corner beside the reverse, where that is
  // wide enough, else below.
  const Ruler in_corner = cdli ? ruler_for(mm_per_px, right.width) : Ruler{};
  plan.ruler = in_corner.length_cm > 0 ? in_corner : ruler_for(mm_per_px, wide);
  // Of a tablet that is narrower than a ruler of one centimetre: it reaches below the edges, too.
  if (plan.ruler.length_cm == 0) {
    plan.ruler = ruler_for(mm_per_px, left.width + wide + right.width + 2 * gap);
  }
  const bool below = in_corner.length_cm == 0 && plan.ruler.length_cm > 0;
  const int air = below && gap == 0 ? plan.ruler.height_px / 2 : 0;
  plan.width = left.width + wide + right.width + 4 * gap;
  plan.height = high + gap + (below ? air + plan.ruler.height_px + gap + air : 0);

  const int column_x = 2 * gap + left.width;
  const auto put = [&](Face face, int x, int y) { plan.corners[static_cast<std::size_t>(face)] = {x, y}; };
  int y = gap;
  for (const Face face : column) {
    const Image& view = views[face];
    int row = view.height;
    if (face == Face::kObverse) {
      row = std::max({view.height, left.height, right.height});
      put(Face::kLeft, gap, y + (row - left.height) / 2);
      put(Face::kRight, column_x + wide + gap, y + (row - right.height) / 2);
    }
    put(face, column_x + (wide - view.width) / 2, y + (row - view.height) / 2);
    y += row + gap;
  }
  const int most_left = plan.width - gap - plan.ruler.width_px;
  const int middle = column_x + (wide - plan.ruler.width_px) / 2;
  plan.ruler_corner = below ? Eigen::Vector2i(std::clamp(middle, gap, std::max(gap, most_left)), y + air)
                            : Eigen::Vector2i(column_x + wide + gap,
                                              plan.height - plan.ruler.height_px - plan.ruler.height_px / 4);
  return plan;
}

}  // namespace

const char* cdli_suffix(Face face) {
  switch (face) {
    case Face::kObverse:
      return "o";
    case Face::kReverse:
      return "r";
    case Face::kLeft:
      return "le";
    case Face::kRight:
      return "re";
    case Face::kTop:
      return "te";
    case Face::kBottom:
      break;
  }
  return "be";
}

Image fatcross(const SixViews& views, FatcrossKind kind, Rgb8 ground) {
  const Plan plan = plan_of(views, kind);
  Image sheet = filled_image(plan.width, plan.height, ground);
  sheet.mm_per_px = views[Face::kObverse].mm_per_px;
  for (const Face face : kSixViewOrder) {
    const Eigen::Vector2i& corner = plan.corners[static_cast<std::size_t>(face)];
    blit(sheet, views[face], corner.x(), corner.y());
  }
  draw_ruler(sheet, plan.ruler, plan.ruler_corner.x(), plan.ruler_corner.y(), ink_on(ground));
  return sheet;
}

std::array<Eigen::Vector2i, kFaceCount> fatcross_corners(const SixViews& views, FatcrossKind kind) {
  return plan_of(views, kind).corners;
}

}  // namespace dubsar
