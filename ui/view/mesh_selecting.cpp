// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/mesh_selecting.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace dubsar::ui {

namespace {

constexpr const char* kVertex = R"glsl(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_model;
void main() { gl_Position = clip_from_model * vec4(position, 1.0); }
)glsl";

/// A vertex in, whether it is selected out.
constexpr const char* kPoint = R"glsl(#version 410 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_model;
uniform sampler2D mask;
uniform sampler2D depth_map;
uniform int visible_only;
uniform int step;             // 0 union, 1 intersection, 2 difference
uniform float slack;          // of clip depth
uniform usamplerBuffer before;
uniform int any_before;       // else nothing was selected
out uint selected;
void main() {
  gl_Position = clip_from_model * vec4(position, 1.0);
  vec2 at = 0.5 * gl_Position.xy + 0.5;
  bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))) &&
                texture(mask, at).r > 0.5;
  if (inside && visible_only != 0) {
    vec3 towards = vec3(clip_from_model[0].z, clip_from_model[1].z, clip_from_model[2].z);
    bool away = dot(normal, normal) > 0.01 && dot(towards, normal) > 0.0;   // clip z grows away from the eye
    inside = !away && 0.5 * (gl_Position.z - slack) + 0.5 <= texture(depth_map, at).r;
  }
  uint was = any_before != 0 ? texelFetch(before, gl_VertexID).r : 0u;
  uint now = inside ? 1u : 0u;
  selected = step == 0 ? (was | now) : step == 1 ? (was & now) : (was & (1u - now));
}
)glsl";

/// A triangle in, whether it is selected out.
constexpr const char* kGeometry = R"glsl(#version 410 core
layout(triangles) in;
layout(points, max_vertices = 1) out;
uniform sampler2D mask;
uniform sampler2D depth_map;
uniform int visible_only;
uniform int step;             // 0 union, 1 intersection, 2 difference
uniform int first_face;
uniform float slack;          // of clip depth
uniform usamplerBuffer before;
uniform int any_before;       // else nothing was selected
out uint selected;
void main() {
  vec3 middle = (gl_in[0].gl_Position.xyz + gl_in[1].gl_Position.xyz + gl_in[2].gl_Position.xyz) / 3.0;
  vec2 at = 0.5 * middle.xy + 0.5;
  bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))) &&
                texture(mask, at).r > 0.5;
  if (inside && visible_only != 0) {
    vec3 a = gl_in[0].gl_Position.xyz;
    vec3 b = gl_in[1].gl_Position.xyz;
    vec3 c = gl_in[2].gl_Position.xyz;
    bool towards = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
    inside = towards && 0.5 * (middle.z - slack) + 0.5 <= texture(depth_map, at).r;
  }
  uint was = any_before != 0 ? texelFetch(before, first_face + gl_PrimitiveIDIn).r : 0u;
  uint now = inside ? 1u : 0u;
  selected = step == 0 ? (was | now) : step == 1 ? (was & now) : (was & (1u - now));
  EmitVertex();
  EndPrimitive();
}
)glsl";

}  // namespace

std::vector<std::uint8_t> polygon_mask(const std::vector<Eigen::Vector2f>& corners, int width, int height) {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  std::vector<float> crossings;
  for (int y = 0; y < height; ++y) {
    const float line = static_cast<float>(y) + 0.5F;
    crossings.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2f& a = corners[k];
      const Eigen::Vector2f& b = corners[(k + 1) % corners.size()];
      if ((a.y() <= line) != (b.y() <= line)) {
        crossings.push_back(a.x() + (line - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    std::ranges::sort(crossings);
    const std::size_t row = static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const int from = std::clamp(static_cast<int>(std::ceil(crossings[k] - 0.5F)), 0, width);
      const int to = std::clamp(static_cast<int>(std::ceil(crossings[k + 1] - 0.5F)), 0, width);
      std::fill(mask.begin() + static_cast<std::ptrdiff_t>(row) + from,
                mask.begin() + static_cast<std::ptrdiff_t>(row) + std::max(from, to), std::uint8_t{255});
    }
  }
  return mask;
}

std::size_t MeshSelecting::most() {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return static_cast<std::size_t>(std::max(texels, 0));
}

MeshSelecting::MeshSelecting(MeshElement of, std::size_t count)
    : program_(of == MeshElement::kFace ? kVertex : kPoint, of == MeshElement::kFace ? kGeometry : nullptr,
               nullptr, {"selected"}),
      of_(of),
      count_(count) {
  glGenBuffers(2, buffers_);
  glGenTextures(2, textures_);
  for (int k = 0; k < 2; ++k) {
    glBindBuffer(GL_TEXTURE_BUFFER, buffers_[k]);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(std::max<std::size_t>(1, count) * 4), nullptr,
                 GL_DYNAMIC_COPY);
    glBindTexture(GL_TEXTURE_BUFFER, textures_[k]);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, buffers_[k]);
  }
}

MeshSelecting::~MeshSelecting() {
  glDeleteTextures(2, textures_);
  glDeleteBuffers(2, buffers_);
}

void MeshSelecting::set(SelectionMarks selected) {
  marks_.reset();
  selected_ = std::move(selected);
  glBindBuffer(GL_TEXTURE_BUFFER, buffers_[current_]);
  glBufferSubData(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(std::min(count_, selected_->size()) * 4),
                  selected_->data());
}

void MeshSelecting::begin(const Eigen::Matrix4f& clip_from_model, const std::vector<std::uint8_t>& mask,
                          int width, int height, const FrameTarget* seen, SelectionStep step) {
  mask_.upload(width, height, 1, mask.data(), false);
  if (seen != nullptr) {
    depth_.copy_depth_of(*seen);
  }
  program_.use();
  program_.set("clip_from_model", clip_from_model);
  program_.set("mask", 0);
  program_.set("depth_map", 1);
  program_.set("before", 2);
  program_.set("visible_only", seen != nullptr ? 1 : 0);
  program_.set("step", static_cast<int>(step));
  program_.set("any_before", selected_ ? 1 : 0);
  program_.set("slack", 0.004F);
  marks_ = std::make_shared<std::vector<std::uint32_t>>();
  marks_->reserve(count_);
  drawn_ = 0;
}

/// Of those that a call has drawn, the next takes the marks: by then the card is done with them.
bool MeshSelecting::go_on(const MeshBuffers& mesh) {
  if (!marks_) {
    return false;
  }
  const auto began = std::chrono::steady_clock::now();
  const std::size_t first = marks_->size();
  marks_->resize(drawn_);
  glBindBuffer(GL_TEXTURE_BUFFER, buffers_[1 - current_]);
  glGetBufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(first * 4),
                     static_cast<GLsizeiptr>((drawn_ - first) * 4), marks_->data() + first);
  if (drawn_ == count_) {
    selected_ = std::exchange(marks_, nullptr);
    current_ = 1 - current_;
    return false;
  }
  const std::size_t count = std::min(at_a_time_.count(), count_ - drawn_);
  draw(mesh, count);
  at_a_time_.took(count, std::chrono::steady_clock::now() - began);
  return true;
}

/// The next `count` of them.
void MeshSelecting::draw(const MeshBuffers& mesh, std::size_t count) {
  // Nothing is drawn, but some drivers want a whole frame to not draw into.
  no_picture_.resize(16, 16);
  no_picture_.bind();
  program_.use();
  program_.set("first_face", static_cast<int>(drawn_));
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, mask_.id());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth_.width() > 0 ? depth_.depth() : mask_.id());
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_BUFFER, textures_[current_]);
  glActiveTexture(GL_TEXTURE0);
  glEnable(GL_RASTERIZER_DISCARD);
  glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers_[1 - current_],
                    static_cast<GLintptr>(drawn_ * 4), static_cast<GLsizeiptr>(count * 4));
  mesh.bind();
  glBeginTransformFeedback(GL_POINTS);
  if (of_ == MeshElement::kFace) {
    mesh.draw_faces(drawn_, count);
  } else {
    mesh.draw_points(drawn_, count);
  }
  glEndTransformFeedback();
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  drawn_ += count;
}

}  // namespace dubsar::ui
