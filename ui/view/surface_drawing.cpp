// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How much of the surface is drawn when: little while it is turned, all of it, piece by piece, at rest.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

#include "ui/view/face_runs.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

namespace {

/// A picture that takes longer to draw makes the window feel stuck while it is turned.
constexpr double kSlowFrameS = 0.05;
/// A machine that draws one so fast is given more.
constexpr double kFastFrameS = 0.008;
constexpr std::size_t kMostFacesInMotion = std::size_t{1} << 30U;

}  // namespace

bool SurfaceView::draw(const OrbitCamera& camera, const Look& look, int width, int height) {
  const Scene scene{camera, look, std::max(1, width), std::max(1, height)};
  const bool changed = dirty_ || !(scene == scene_) || texture() == 0;
  scene_ = scene;
  dirty_ = false;
  return changed ? draw_in_motion(scene) : !whole_ && draw_more(scene);
}

/// The level of detail that is soon drawn, and half the pixels where that is slow still.
bool SurfaceView::draw_in_motion(const Scene& scene) {
  Scene rough = scene;
  if (slow_) {
    rough.width = std::max(1, scene.width / 2);
    rough.height = std::max(1, scene.height / 2);
  }
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  level_drawn_ = level_within(levels_, scene.camera.clip_from_model(aspect), faces_in_motion_);
  const bool all = level_drawn_ + 1 == levels_.size();
  glFinish();  // what is under way from before, such as a new mesh, is no fault of this picture
  const auto began = std::chrono::steady_clock::now();
  shown_layer_ = kInMotion;
  Layer& layer = layers_[shown_layer_];
  clear(layer, rough);
  faces_drawn_ = 0;
  draw_geometry(layer, rough, level_drawn_, levels_[level_drawn_]);
  draw_marks(layer, rough);
  light(layer, rough);
  glFinish();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
  next_block_ = 0;
  faces_to_come_ = true;
  whole_ = all && !slow_;
  if (spent.count() > kSlowFrameS) {
    faces_in_motion_ = slow_ ? std::max(kFacesInMotion, faces_in_motion_ / 2) : faces_in_motion_;
    slow_ = true;
  } else if (spent.count() < kFastFrameS) {
    slow_ = false;  // four times the pixels are drawn soon enough too
    // What these few took says little of many more: by it, as many as allowed must be drawn so fast.
    const double most_s = spent.count() * static_cast<double>(faces_in_motion_) /
                          static_cast<double>(std::max<std::size_t>(1, faces_drawn_));
    if (!all && most_s < kFastFrameS) {
      faces_in_motion_ = std::min(2 * faces_in_motion_, kMostFacesInMotion);
    }
  }
  return !whole_;
}

/// Some more faces of the whole surface, from `next_block` on, as many as this machine draws soon enough.
/// True while more is to come.
bool SurfaceView::add_faces(Layer& layer, const Scene& scene, std::size_t& next_block) {
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  const Eigen::Matrix4f clip_from_model = scene.camera.clip_from_model(aspect);
  if (next_block == 0 && clear(layer, scene)) {
    return true;  // taking the memory took as long as a piece
  }
  const std::span<const FaceBlock> blocks = levels_.back();
  // What is not seen casts shadows.
  const bool every_face = scene.look.lamp && scene.look.shadows && !layer.shadow_stands;
  std::size_t end = next_block;
  std::size_t faces = 0;
  for (; end < blocks.size() && faces < faces_at_a_time_.count(); ++end) {
    faces += every_face ? blocks[end].count : faces_in(seen_runs(blocks.subspan(end, 1), clip_from_model));
  }
  const auto began = std::chrono::steady_clock::now();
  draw_geometry(layer, scene, levels_.size() - 1, blocks.subspan(next_block, end - next_block));
  glFinish();  // else a driver that queues would let the frames pile up, and input wait behind them
  faces_at_a_time_.took(faces, std::chrono::steady_clock::now() - began);
  next_block = end;
  return next_block < blocks.size();
}

/// Of the picture that is not shown yet.
bool SurfaceView::draw_more(const Scene& scene) {
  Layer& layer = layers_[kAtRest];
  faces_drawn_ = next_block_ == 0 ? 0 : faces_drawn_;
  if (faces_to_come_) {
    faces_to_come_ = add_faces(layer, scene, next_block_);
    return true;  // the light in a frame of its own: over all pixels it takes as long as a piece
  }
  draw_marks(layer, scene);
  light(layer, scene);
  shown_layer_ = kAtRest;
  level_drawn_ = levels_.size() - 1;
  whole_ = true;
  return false;
}

void SurfaceView::begin_still(const OrbitCamera& camera, const Look& look, int width, int height,
                              bool same_light) {
  if (!still_) {
    still_ = std::make_unique<Layer>();
  }
  still_->shadow_stands = same_light && still_->shadow.width() > 0;
  still_scene_ = {camera, look, width, height};
  still_block_ = 0;
}

bool SurfaceView::draw_still() {
  if (!still_) {
    return false;
  }
  const std::size_t shown = faces_drawn_;
  const bool more = add_faces(*still_, still_scene_, still_block_);
  faces_drawn_ = shown;
  if (more) {
    return true;
  }
  draw_marks(*still_, still_scene_);
  light(*still_, still_scene_);
  return false;
}

void SurfaceView::end_still() {
  still_.reset();
}

void SurfaceView::draw_whole(const OrbitCamera& camera, const Look& look, int width, int height) {
  draw_level(levels_.size() - 1, camera, look, width, height);
}

void SurfaceView::draw_level(std::size_t level, const OrbitCamera& camera, const Look& look, int width,
                             int height) {
  const Scene scene{camera, look, std::max(1, width), std::max(1, height)};
  shown_layer_ = kAtRest;
  Layer& layer = layers_[shown_layer_];
  clear(layer, scene);
  faces_drawn_ = 0;
  level_drawn_ = level;
  draw_geometry(layer, scene, level, levels_[level]);
  draw_marks(layer, scene);
  light(layer, scene);
  scene_ = scene;
  dirty_ = false;
  next_block_ = 0;
  faces_to_come_ = true;
  whole_ = level + 1 == levels_.size();
}

}  // namespace dubsar::ui
