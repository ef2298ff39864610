// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is under a polygon or a point of the last picture, and how the selected is shown.
#include <epoxy/gl.h>

#include "ui/gl/card_memory.h"
#include "ui/view/surface_view.h"

namespace dubsar::ui {

namespace {

void bind_buffer_texture(int unit, unsigned texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_BUFFER, texture);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace

bool SurfaceView::can_select(MeshElement of) const {
  return mesh_ && mesh_->is_whole() && !selection_refused_ && mesh_->vertices() <= MeshSelecting::most() &&
         (of == MeshElement::kVertex || mesh_->faces() <= MeshSelecting::most());
}

/// False where the graphics card has no room for one.
bool SurfaceView::begin_selection(MeshElement of) {
  if (!selection_ || selection_->of() != of) {
    selection_.reset();  // two at once would be too much for a small card
    static_cast<void>(card_has_refused());
    selection_ = std::make_unique<MeshSelecting>(*mesh_, of);
    selection_refused_ = card_has_refused();
    if (selection_refused_) {
      selection_.reset();
    }
  }
  return selection_ != nullptr;
}

bool SurfaceView::select(MeshElement of, const std::vector<Eigen::Vector2f>& corners, SelectionStep step,
                         bool through) {
  if (!can_select(of) || !whole_ || corners.size() < 3 ||
      (of == MeshElement::kFace && mesh_->points_only())) {
    return false;
  }
  if (!begin_selection(of)) {
    return false;
  }
  selection_->begin(scene_.camera, polygon_mask(corners, scene_.width, scene_.height), scene_.width,
                    scene_.height, through ? nullptr : &shown().target, step);
  return true;
}

bool SurfaceView::select_more() {
  if (!selection_ || !selection_->is_under_way()) {
    return false;
  }
  const bool more = selection_->go_on();
  dirty_ = dirty_ || !more;
  return more;
}

void SurfaceView::set_selection(MeshElement of, SelectionMarks selected) {
  if (can_select(of) && begin_selection(of)) {
    selection_->set(std::move(selected));
    dirty_ = true;
  }
}

/// Of the program in use, for faces of a level that begin at `first_face`.
void SurfaceView::show_selection(ShaderProgram& surface, std::size_t level, std::size_t first_face) {
  if (!selection_ || !selection_->selected()) {
    return;
  }
  if (selection_->of() == MeshElement::kVertex) {
    surface.set("selection", 2);  // all levels have the same vertices
  } else if (level + 1 == levels_.size()) {
    surface.set("selection", 1);
  } else {
    surface.set("selection", 3);
    first_face += mesh_->first_of(level);
    bind_buffer_texture(2, mesh_->made_of());
  }
  surface.set("first_face", static_cast<int>(first_face));
  bind_buffer_texture(1, selection_->texture());
}

void SurfaceView::clear_selection() {
  selection_.reset();
  dirty_ = true;
}

std::optional<Eigen::Vector3f> SurfaceView::point_at(const Eigen::Vector2f& px) const {
  const Layer& layer = shown();
  const int x = static_cast<int>(px.x());
  const int y = scene_.height - 1 - static_cast<int>(px.y());
  if (layer.target.width() != scene_.width || x < 0 || y < 0 || x >= scene_.width || y >= scene_.height) {
    return std::nullopt;
  }
  layer.target.bind();
  float depth = 1;
  glReadPixels(x, y, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (depth >= 1) {
    return std::nullopt;
  }
  const float aspect = static_cast<float>(scene_.width) / static_cast<float>(scene_.height);
  // The depth is that of the pixel's middle: on a slope it belongs to no other place in the pixel.
  const Eigen::Vector2f middle = px.array().floor() + 0.5F;
  const Eigen::Vector4f clip(2 * middle.x() / static_cast<float>(scene_.width) - 1,
                             1 - 2 * middle.y() / static_cast<float>(scene_.height), 2 * depth - 1, 1);
  return Eigen::Vector3f((scene_.camera.clip_from_model(aspect).inverse() * clip).head<3>());
}

}  // namespace dubsar::ui
