// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/still_picture.h"

#include <algorithm>

namespace dubsar::ui {

namespace {

constexpr int kTilePx = 512;  ///< of a side; even a processor lights so many soon enough
/// Drawn around each tile and thrown away: discs and the shading look over the tile's edge, at most so far.
constexpr int kMarginPx = 24;
constexpr int kDrawnPx = kTilePx + 2 * kMarginPx;

int tiles_over(int px) {
  return (px + kTilePx - 1) / kTilePx;
}

}  // namespace

StillPicture::StillPicture(const OrbitCamera& camera, const Look& look, int width, int height)
    : camera_(camera),
      look_(look),
      image_(filled_image(width, height, {0, 0, 0})),
      across_(tiles_over(width)),
      tiles_(across_ * tiles_over(height)) {}

OrbitCamera StillPicture::camera_of(int tile) const {
  const float mm_per_px = camera_.mm_per_px(static_cast<float>(image_.height));
  const int left = tile % across_ * kTilePx;
  const int top = tile / across_ * kTilePx;
  // Its middle, from the middle of the whole, y down.
  const float x = static_cast<float>(left) + 0.5F * static_cast<float>(kTilePx - image_.width);
  const float y = static_cast<float>(top) + 0.5F * static_cast<float>(kTilePx - image_.height);
  OrbitCamera camera = camera_;
  camera.centre_mm += camera_.eye_from_model.conjugate() * Eigen::Vector3f(x * mm_per_px, -y * mm_per_px, 0);
  camera.half_height_mm = 0.5F * static_cast<float>(kDrawnPx) * mm_per_px;
  return camera;
}

bool StillPicture::draw_on(SurfaceView& view) {
  if (next_ >= tiles_) {
    return false;
  }
  if (!begun_) {
    view.begin_still(camera_of(next_), look_, kDrawnPx, kDrawnPx, next_ > 0);
    begun_ = true;
  }
  if (view.draw_still()) {
    return true;
  }
  const Image tile = view.read_still();
  const int left = next_ % across_ * kTilePx;
  const int top = next_ / across_ * kTilePx;
  const int width = std::min(kTilePx, image_.width - left);
  const int height = std::min(kTilePx, image_.height - top);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::copy_n(tile.bytes.data() + tile.offset(x + kMarginPx, y + kMarginPx), 3,
                  image_.bytes.data() + image_.offset(left + x, top + y));
    }
  }
  begun_ = false;
  ++next_;
  if (next_ == tiles_) {
    view.end_still();
  }
  return next_ < tiles_;
}

double StillPicture::fraction() const {
  return tiles_ > 0 ? static_cast<double>(next_) / tiles_ : 1.0;
}

}  // namespace dubsar::ui
