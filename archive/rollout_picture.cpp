// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>

#include "archive/glyphs.h"
#include "archive/rollout.h"
#include "archive/scale_bar.h"

namespace dubsar {

namespace {

/// Columns at the right of the clay.
Image with_sides(const Image& picture, const std::array<RolloutSide, 4>& sides, double top_mm, Rgb8 ground) {
  const int scale = text_scale_beside(picture.mm_per_px);
  const int tick = kGlyphHeight * scale;
  const int gap = 2 * scale;
  int words = 0;
  for (const RolloutSide& side : sides) {
    words = std::max(words, text_width(to_string(side.face), scale));
  }
  Image wider = filled_image(picture.width + 3 * gap + std::max(tick, words), picture.height, ground);
  wider.mm_per_px = picture.mm_per_px;
  blit(wider, picture, 0, 0);
  const int x = picture.width + gap;
  const int thick = std::max(1, scale / 2);
  for (const RolloutSide& side : sides) {
    const int row = static_cast<int>(std::lround((top_mm + side.from_mm) / picture.mm_per_px));
    const int y = std::clamp(row, 0, std::max(0, picture.height - thick));
    fill_rectangle(wider, x, y, tick, thick, ink_on(ground));
    draw_text(wider, x, y + thick + gap, to_string(side.face), ink_on(ground), scale);
  }
  return wider;
}

}  // namespace

Result<Image> rollout_picture(const RenderScene& scene, const RigidTransform& tablet_from_model,
                              const RenderOptions& options, const JobContext& job) {
  const Result<Rollout> rollout = rolled_out(scene, tablet_from_model, job);
  if (!rollout) {
    return std::unexpected(rollout.error());
  }
  const RenderScene flat(rollout->mesh);
  const Result<Framing> framing = framing_of(flat, rollout_camera(), options);
  if (!framing) {
    return std::unexpected(framing.error());
  }
  const Result<Image> image = render(flat, rollout_camera(), options, job);
  if (!image) {
    return std::unexpected(image.error());
  }
  return with_scale_bar(with_sides(*image, rollout->sides, framing->top_mm, options.background),
                        options.background);
}

}  // namespace dubsar
