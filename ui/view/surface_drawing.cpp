// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How much of the surface is drawn when: little while it is turned, all of it, piece by piece, at rest.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

#include "core/stage_times.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

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
  const bool half = motion_.is_slow();
  if (half) {
    rough.width = std::max(1, scene.width / 2);
    rough.height = std::max(1, scene.height / 2);
  }
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  level_drawn_ = level_within(levels_, scene.camera.clip_from_model(aspect), motion_.faces());
  const bool all = level_drawn_ + 1 == levels_.size();
  glFinish();  // what is under way from before, such as a new mesh, is no fault of this picture
  const auto began = std::chrono::steady_clock::now();
  shown_layer_ = kInMotion;
  Layer& layer = layers_[shown_layer_];
  clear(layer, rough);
  faces_drawn_ = 0;
  draw_surface(layer, rough, level_drawn_, levels_[level_drawn_]);
  if (casts_shadows(layer, rough)) {
    const std::size_t level = shadow_level(layer, rough, level_drawn_);
    draw_shadow(layer, rough, level, levels_[level]);
  }
  draw_marks(layer, rough);
  light(layer, rough);
  glFinish();
  const double spent_s = seconds_since(began);
  next_ = {};
  faces_to_come_ = true;
  whole_ = all && !half;
  in_motion_.look.light = rough.look.light;  // the lamp may be dragged
  if (rough.look != in_motion_.look || rough.width != in_motion_.width || rough.height != in_motion_.height) {
    motion_.begin_other_pictures();
    in_motion_ = rough;
  }
  motion_.took(faces_drawn_, all, spent_s);
  return !whole_;
}

/// Some more faces of the whole surface, and before them of what casts its shadows, as many as this machine
/// draws soon enough. True while more is to come.
bool SurfaceView::add_faces(Layer& layer, const Scene& scene, Progress& next) {
  if (next.surface == 0 && next.shadow == 0 && clear(layer, scene)) {
    return true;  // taking the memory took as long as a piece
  }
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  const Eigen::Matrix4f clip_from_model = scene.camera.clip_from_model(aspect);
  const std::size_t whole = levels_.size() - 1;
  const std::size_t casting = shadow_level(layer, scene, whole);
  const bool shadows = casts_shadows(layer, scene) && next.shadow < levels_[casting].size();
  const std::span<const FaceBlock> blocks = levels_[shadows ? casting : whole];
  std::size_t& done = shadows ? next.shadow : next.surface;
  std::size_t end = done;
  std::size_t faces = 0;
  for (; end < blocks.size() && faces < faces_at_a_time_.count(); ++end) {
    faces += shadows ? blocks[end].count : faces_in(seen_runs(blocks.subspan(end, 1), clip_from_model));
  }
  const auto began = std::chrono::steady_clock::now();
  if (shadows) {
    draw_shadow(layer, scene, casting, blocks.subspan(done, end - done));
  } else {
    draw_surface(layer, scene, whole, blocks.subspan(done, end - done));
  }
  glFinish();  // else a driver that queues would let the frames pile up, and input wait behind them
  faces_at_a_time_.took(faces, std::chrono::steady_clock::now() - began);
  done = end;
  return shadows || next.surface < blocks.size();
}

/// Of the picture that is not shown yet.
bool SurfaceView::draw_more(const Scene& scene) {
  Layer& layer = layers_[kAtRest];
  faces_drawn_ = next_.surface == 0 ? 0 : faces_drawn_;
  if (faces_to_come_) {
    faces_to_come_ = add_faces(layer, scene, next_);
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
  still_next_ = {};
}

bool SurfaceView::draw_still() {
  if (!still_) {
    return false;
  }
  const std::size_t shown = faces_drawn_;
  const bool more = add_faces(*still_, still_scene_, still_next_);
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
  draw_surface(layer, scene, level, levels_[level]);
  if (casts_shadows(layer, scene)) {
    const std::size_t casting = shadow_level(layer, scene, level);
    draw_shadow(layer, scene, casting, levels_[casting]);
  }
  draw_marks(layer, scene);
  light(layer, scene);
  scene_ = scene;
  dirty_ = false;
  next_ = {};
  faces_to_come_ = true;
  whole_ = level + 1 == levels_.size();
}

}  // namespace dubsar::ui
