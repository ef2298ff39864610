// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/six_views.h"

#include <algorithm>

#include "archive/scale_bar.h"

namespace dubsar {

Result<SixViews> render_six_views(const RenderScene& scene, const SixViewOptions& options,
                                  const JobContext& job) {
  RenderOptions render_options = options.render;
  if (const Status checked = render_options.check(); !checked) {
    return std::unexpected(checked.error());
  }
  if (render_options.mm_per_px <= 0) {
    render_options.mm_per_px = scale_for(scene, options.tablet_from_model, render_options.longest_px);
  }
  SixViews views;
  int done = 0;
  for (const Face face : kSixViewOrder) {
    job.progress("pictures", static_cast<double>(done++) / kFaceCount);
    Result<Image> image = render(scene, face_camera(face, options.tablet_from_model), render_options, job);
    if (!image) {
      return std::unexpected(image.error());
    }
    views.of[static_cast<std::size_t>(face)] = std::move(*image);
  }
  job.progress("pictures", 1.0);
  return views;
}

Image six_view_sheet(const SixViews& views, const SixViewOptions& options) {
  const Image& obverse = views[Face::kObverse];
  const Image& reverse = views[Face::kReverse];
  const Image& top = views[Face::kTop];
  const Image& bottom = views[Face::kBottom];
  const Image& left = views[Face::kLeft];
  const Image& right = views[Face::kRight];
  const int gap = std::max(0, options.gap_px);
  const int column = std::max({obverse.width, reverse.width, top.width, bottom.width});
  const int middle_row = std::max({obverse.height, left.height, right.height});
  const int width = 4 * gap + left.width + column + right.width;
  // Only the column reaches below the obverse: the bar goes into the free corner beside the reverse, or on a
  // line of its own where the edges are too narrow for it.
  const ScaleBar bar = scale_bar_for(obverse.mm_per_px, column, options.bar_text_scale);
  const bool bar_has_corner = bar.width_px <= right.width;
  const int bar_line = options.scale_bar && !bar_has_corner ? bar.height_px + std::max(gap, 4) : 0;
  const int height = 5 * gap + top.height + middle_row + bottom.height + reverse.height + bar_line;
  Image sheet = filled_image(width, height, options.render.background);
  sheet.mm_per_px = obverse.mm_per_px;

  const int column_x = 2 * gap + left.width;
  const int obverse_y = 2 * gap + top.height;
  const int bottom_y = obverse_y + middle_row + gap;
  const int reverse_y = bottom_y + bottom.height + gap;
  const auto place = [&](const Image& view, int y) {
    blit(sheet, view, column_x + (column - view.width) / 2, y);
  };
  place(top, gap);
  place(obverse, obverse_y);
  place(bottom, bottom_y);
  place(reverse, reverse_y);
  blit(sheet, left, gap, obverse_y);
  blit(sheet, right, column_x + column + gap, obverse_y);

  if (options.scale_bar) {
    const int x = bar_has_corner ? column_x + column + gap : column_x;
    draw_scale_bar(sheet, bar, x, height - std::max(gap, 4) - bar.height_px,
                   ink_on(options.render.background));
  }
  return sheet;
}

Result<Image> render_six_view_sheet(const RenderScene& scene, const SixViewOptions& options,
                                    const JobContext& job) {
  const Result<SixViews> views = render_six_views(scene, options, job);
  if (!views) {
    return std::unexpected(views.error());
  }
  return six_view_sheet(*views, options);
}

}  // namespace dubsar
