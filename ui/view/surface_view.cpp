// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/surface_view.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "ui/view/clay_sphere.h"
#include "ui/view/shaders.h"

namespace dubsar::ui {

namespace {

/// Pixels of a shadow's side: of a tablet of 110 mm 0.07 mm each, and twice that while a slow machine turns
/// it.
constexpr int kShadowPx = 2048;
constexpr int kRoughShadowPx = 1024;
/// Noise of the surface casts no shadow.
constexpr float kShadowSlackMm = 0.02F;
/// A pixel of the shadow is asked for around where it is (3 × 3): on a slope that is so much deeper.
constexpr float kShadowSlopes = 2.5F;

/// A surface_* shader for what may be shown on it, or for bare clay.
std::string surface_shader(const char* source, bool everything) {
  return std::string("#version 410 core\n") + (everything ? "#define EVERYTHING\n" : "") + kIsMarked + source;
}

ShaderProgram surface_program(bool everything) {
  return ShaderProgram(surface_shader(kSurfaceVertex, everything).c_str(),
                       surface_shader(kSurfaceFragment, everything).c_str());
}

void bind_texture(int unit, unsigned texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture);
}

}  // namespace

bool tells(const ShownMesh& mesh, Overlay overlay) {
  switch (overlay) {
    case Overlay::kColours:
      return !mesh.colours.empty();
    case Overlay::kReliability:
      return mesh.has_reliability;
    case Overlay::kScans:
      return mesh.has_scans;
    case Overlay::kFlags:
      return mesh.has_flags;
    case Overlay::kClay:
    case Overlay::kValue:
      break;
  }
  return true;
}

SurfaceView::SurfaceView()
    : clay_(surface_program(false)),
      surface_(surface_program(true)),
      shadow_(kShadowVertex, kShadowFragment),
      lighting_(kPictureVertex, kLightFragment) {
  const Image sphere = clay_sphere();
  sphere_.upload(sphere.width, sphere.height, 3, sphere.bytes.data(), true);
  const auto colours = overlay_colours();
  colour_map_.upload(static_cast<int>(colours.size()), 1, 3, colours.front().data(), true);
  glGenVertexArrays(1, &no_vertices_);
  warm_up();
}

/// Drivers, Mesa's software renderer above all, compile a program when something is drawn with it for the
/// first time, half a second for these: now, while nobody looks, instead of when the first mesh comes.
void SurfaceView::warm_up() {
  ShownMesh face;
  face.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  face.normals.assign(3, packed_normal(Eigen::Vector3f::UnitZ()));
  face.has_normals = true;
  face.traits.resize(3);
  face.faces = {{0, 1, 2}};
  for (const Eigen::Vector3f& corner : face.positions) {
    face.box_mm.extend(corner);
  }
  face.blocks = {{0, 1, face.box_mm}};
  show(face);
  OrbitCamera camera;
  camera.fit(face.box_mm, 1);
  for (const bool other : {true, false}) {  // under a lamp the program that casts shadows too
    Look look;
    look.lamp = other;
    look.overlay = other ? Overlay::kFlags : Overlay::kClay;
    draw_whole(camera, look, 9, 7);
  }
  glFinish();
  mesh_.reset();
  levels_ = {{}};
  cells_mm_.clear();
  box_mm_.setEmpty();
  for (Layer& layer : layers_) {
    layer.picture.release();
  }
  whole_ = false;
  faces_drawn_ = 0;
}

void SurfaceView::show(const ShownMesh& mesh) {
  while (show_soon(mesh) == Arrival::kUnderWay) {
  }
}

Arrival SurfaceView::show_soon(const ShownMesh& mesh) {
  if (!coming_) {
    coming_ = std::make_unique<MeshBuffers>(mesh);
  } else if (!coming_->is_uploaded()) {
    coming_->upload();
  } else {
    take_shown(mesh);
    return Arrival::kShown;  // its first picture comes in a frame of its own
  }
  if (coming_->is_refused()) {
    coming_.reset();
    if (!mesh_) {
      return Arrival::kRefused;
    }
    mesh_.reset();  // without it there may be room
    selection_.reset();
    dirty_ = true;
  }
  return Arrival::kUnderWay;
}

void SurfaceView::take_shown(const ShownMesh& mesh) {
  mesh_ = std::move(coming_);
  selection_.reset();
  selection_refused_ = false;
  levels_.clear();
  cells_mm_.clear();
  for (const ShownLevel& level : mesh.coarser) {
    levels_.push_back(level.blocks);
    cells_mm_.push_back(level.detail.cell_mm);
  }
  levels_.push_back(mesh.blocks);
  has_normals_ = mesh.has_normals;
  box_mm_ = mesh.box_mm;
  dirty_ = true;
}

void SurfaceView::show_points(const ColouredPoints* points) {
  points_ =
      points != nullptr && !points->positions_mm.empty() ? std::make_unique<PointBuffers>(*points) : nullptr;
  dirty_ = true;
}

void SurfaceView::set_values(const std::vector<float>& values) {
  if (mesh_) {
    mesh_->set_values(values);
    dirty_ = true;
  }
}

void SurfaceView::set_traits(const std::vector<std::array<std::uint8_t, 4>>& traits) {
  if (mesh_) {
    mesh_->set_traits(traits);
    dirty_ = true;
  }
}

OrbitCamera SurfaceView::lamp_of(const Scene& scene) const {
  OrbitCamera lamp;
  const Eigen::Vector3f towards = scene.look.light.normalized();
  const Eigen::Quaternionf lamp_from_eye =
      Eigen::Quaternionf::FromTwoVectors(towards, Eigen::Vector3f::UnitZ());
  lamp.eye_from_model = lamp_from_eye * scene.camera.eye_from_model;
  lamp.fit(box_mm_, 1.0F);
  return lamp;
}

Eigen::Matrix4f SurfaceView::light_clip_from_model(const Scene& scene) const {
  return lamp_of(scene).clip_from_model(1.0F);
}

int SurfaceView::shadow_px(const Layer& layer) const {
  return &layer == &layers_[kInMotion] && motion_.is_slow() ? kRoughShadowPx : kShadowPx;
}

std::size_t SurfaceView::shadow_level(const Layer& layer, const Scene& scene, std::size_t finest) const {
  const float shadow_pixel_mm = lamp_of(scene).mm_per_px(static_cast<float>(shadow_px(layer)));
  const float pixel_mm = scene.camera.mm_per_px(static_cast<float>(scene.height));
  const float seen_mm = std::max(1.5F * shadow_pixel_mm, 2.5F * pixel_mm);
  std::size_t level = 0;
  while (level < finest && cells_mm_[level] > seen_mm) {
    ++level;
  }
  return level;
}

bool SurfaceView::clear(Layer& layer, const Scene& scene) const {
  glDepthMask(GL_TRUE);
  bool resized = layer.target.resize(scene.width, scene.height);
  layer.target.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (casts_shadows(layer, scene)) {
    resized = layer.shadow.resize(shadow_px(layer), shadow_px(layer)) || resized;
    layer.shadow.bind();
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  return resized;
}

ShaderProgram& SurfaceView::begin_surface(const Scene& scene, const Layer& layer, bool everything) {
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  layer.target.bind();
  ShaderProgram& surface = everything ? surface_ : clay_;
  surface.use();
  surface.set("clip_from_model", scene.camera.clip_from_model(aspect));
  surface.set("eye_from_model", Eigen::Matrix3f(scene.camera.eye_from_model.toRotationMatrix()));
  surface.set("clay", scene.look.clay);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  if (!everything) {
    return surface;
  }
  surface.set("towards_viewer", 0.0F);
  surface.set("point_px", 2.0F);
  surface.set("overlay", static_cast<int>(scene.look.overlay));
  surface.set("flat_shading", scene.look.flat ? 1 : 0);
  surface.set("marks", 0);
  surface.set("value_range", scene.look.value_range);
  surface.set("red", scene.look.red);
  surface.set("amber", scene.look.amber);
  surface.set("colour_map", 0);
  surface.set("selected_colour", scene.look.selected);
  surface.set("selection", 0);
  surface.set("selected", 1);
  surface.set("made_of", 2);
  bind_texture(0, colour_map_.id());
  glEnable(GL_PROGRAM_POINT_SIZE);
  return surface;
}

void SurfaceView::draw_faces(std::size_t level, const FaceRun& run) const {
  if (level + 1 == levels_.size()) {
    mesh_->draw_faces(run.first, run.count);
  } else {
    mesh_->draw_level(level, run.first, run.count);
  }
}

void SurfaceView::draw_surface(Layer& layer, const Scene& scene, std::size_t level,
                               std::span<const FaceBlock> blocks) {
  if (!mesh_) {
    return;
  }
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  const bool bare = scene.look.overlay == Overlay::kClay && !scene.look.flat && has_normals_ &&
                    !mesh_->points_only() && (!selection_ || !selection_->selected());
  ShaderProgram& surface = begin_surface(scene, layer, !bare);
  mesh_->bind();
  if (mesh_->points_only()) {
    show_selection(surface, 0, 0);
    surface.set("marks", 2);
    surface.set("point_px",
                std::clamp(0.2F / scene.camera.mm_per_px(static_cast<float>(scene.height)), 2.0F, 12.0F));
    mesh_->draw_points(0, mesh_->vertices());
    return;
  }
  for (const FaceRun& run : seen_runs(blocks, scene.camera.clip_from_model(aspect))) {
    show_selection(surface, level, run.first);
    draw_faces(level, run);
    faces_drawn_ += run.count;
  }
}

/// What is not seen casts shadows too.
void SurfaceView::draw_shadow(Layer& layer, const Scene& scene, std::size_t level,
                              std::span<const FaceBlock> blocks) {
  if (!mesh_ || blocks.empty()) {
    return;
  }
  layer.shadow.bind();
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  shadow_.use();
  shadow_.set("clip_from_model", light_clip_from_model(scene));
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(kShadowSlopes, 0);
  mesh_->bind();
  draw_faces(level, {blocks.front().first, blocks.back().first + blocks.back().count - blocks.front().first});
  glDisable(GL_POLYGON_OFFSET_FILL);
  layer.shadow_slack_mm = kShadowSlackMm + (level < cells_mm_.size() ? 0.5F * cells_mm_[level] : 0.0F);
}

void SurfaceView::draw_marks(Layer& layer, const Scene& scene) {
  if (!points_) {
    return;
  }
  ShaderProgram& surface = begin_surface(scene, layer, true);
  const float mm_per_px = scene.camera.mm_per_px(static_cast<float>(scene.height));
  surface.set("marks", 1);
  surface.set("point_px", std::clamp(2.0F * points_->radius_mm() / mm_per_px, 3.0F, 40.0F));
  surface.set("towards_viewer", points_->bury_mm() / scene.camera.depth_mm);
  points_->draw();
}

void SurfaceView::light(Layer& layer, const Scene& scene) {
  const float aspect = static_cast<float>(scene.width) / static_cast<float>(scene.height);
  layer.picture.resize(scene.width, scene.height);
  layer.picture.bind();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  lighting_.use();
  const Look& look = scene.look;
  const bool shadows = look.lamp && look.shadows && mesh_ != nullptr;
  bind_texture(0, layer.target.colour(0));
  bind_texture(1, layer.target.colour(1));
  bind_texture(2, layer.target.depth());
  bind_texture(3, sphere_.id());
  bind_texture(4, shadows ? layer.shadow.depth() : layer.target.depth());
  lighting_.set("albedo_map", 0);
  lighting_.set("surface_map", 1);
  lighting_.set("depth_map", 2);
  lighting_.set("sphere_map", 3);
  lighting_.set("shadow_map", 4);
  lighting_.set("lamp", look.lamp ? 1 : 0);
  lighting_.set("light", Eigen::Vector3f(look.light.normalized()));
  lighting_.set("shadows", shadows ? 1 : 0);
  lighting_.set("occlusion", look.occlusion ? 1 : 0);
  lighting_.set("radiance", look.radiance);
  lighting_.set("depth_shading", look.depth_shading);
  lighting_.set("ground", look.ground);
  lighting_.set(
      "px", Eigen::Vector2f(1.0F / static_cast<float>(scene.width), 1.0F / static_cast<float>(scene.height)));
  lighting_.set("mm_per_px", scene.camera.mm_per_px(static_cast<float>(scene.height)));
  lighting_.set("depth_mm", scene.camera.depth_mm);
  if (shadows) {
    lighting_.set("shadow_slack", layer.shadow_slack_mm / (2 * lamp_of(scene).depth_mm));
    lighting_.set("light_clip_from_clip", Eigen::Matrix4f(light_clip_from_model(scene) *
                                                          scene.camera.clip_from_model(aspect).inverse()));
  }
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glActiveTexture(GL_TEXTURE0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::size_t SurfaceView::graphics_bytes() const {
  const auto of_layer = [](const Layer& layer) {
    return layer.target.bytes() + layer.shadow.bytes() + layer.picture.bytes();
  };
  std::size_t sum = sphere_.bytes() + colour_map_.bytes() + of_layer(layers_[0]) + of_layer(layers_[1]);
  sum += still_ ? of_layer(*still_) : 0;
  sum += mesh_ ? mesh_->bytes() : 0;
  sum += coming_ ? coming_->bytes() : 0;
  sum += points_ ? points_->bytes() : 0;
  sum += selection_ ? selection_->bytes() : 0;
  return sum;
}

}  // namespace dubsar::ui
