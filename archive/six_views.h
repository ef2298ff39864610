// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "archive/render.h"

namespace dubsar {

struct SixViewOptions {
  RenderOptions render;  ///< mm_per_px 0: scale_for() with its longest_px
  RigidTransform
      tablet_from_model;  ///< x along the lines of writing, y to the top edge, z out of the obverse
  int gap_px = 16;        ///< between views and round them; 0 joins the views edge to edge (CDLI)
  bool scale_bar = true;
  int bar_text_scale = 1;  ///< of the words beside the scale bar, at least
};

/// The six faces at one scale, by Face.
struct SixViews {
  std::array<Image, kFaceCount> of;
  [[nodiscard]] const Image& operator[](Face face) const { return of[static_cast<std::size_t>(face)]; }
};

/// Draws all six faces at the same scale. Errors as render().
[[nodiscard]] Result<SixViews> render_six_views(const RenderScene& scene, const SixViewOptions& options,
                                                const JobContext& job);

/// One sheet of six views, all to scale, unrolled round the tablet: the column top edge, obverse, bottom
/// edge, reverse, with the left and the right edge beside the obverse (CDLI's "fatcross"), on the ground of
/// options.render.background, with a scale bar below the right edge.
[[nodiscard]] Image six_view_sheet(const SixViews& views, const SixViewOptions& options);

/// Both steps.
[[nodiscard]] Result<Image> render_six_view_sheet(const RenderScene& scene, const SixViewOptions& options,
                                                  const JobContext& job);

}  // namespace dubsar
