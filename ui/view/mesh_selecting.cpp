// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/mesh_selecting.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

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
  uint was = texelFetch(before, gl_VertexID).r;
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
  uint was = texelFetch(before, first_face + gl_PrimitiveIDIn).r;
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
  set(std::vector<std::uint32_t>(count, 0));
}

MeshSelecting::~MeshSelecting() {
  glDeleteTextures(2, textures_);
  glDeleteBuffers(2, buffers_);
}

void MeshSelecting::set(const std::vector<std::uint32_t>& selected) {
  glBindBuffer(GL_TEXTURE_BUFFER, buffers_[current_]);
  glBufferSubData(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(std::min(count_, selected.size()) * 4),
                  selected.data());
}

void MeshSelecting::apply(const MeshBuffers& mesh, const Eigen::Matrix4f& clip_from_model,
                          const std::vector<std::uint8_t>& mask, int width, int height, unsigned depth,
                          SelectionStep step) {
  mask_.upload(width, height, 1, mask.data(), false);
  // Nothing is drawn, but some drivers want a whole frame to not draw into.
  no_picture_.resize(16, 16);
  no_picture_.bind();
  program_.use();
  program_.set("clip_from_model", clip_from_model);
  program_.set("mask", 0);
  program_.set("depth_map", 1);
  program_.set("before", 2);
  program_.set("visible_only", depth != 0 ? 1 : 0);
  program_.set("step", static_cast<int>(step));
  program_.set("first_face", 0);
  program_.set("slack", 0.004F);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, mask_.id());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth != 0 ? depth : mask_.id());
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_BUFFER, textures_[current_]);
  glActiveTexture(GL_TEXTURE0);
  const std::size_t next = 1 - current_;
  glEnable(GL_RASTERIZER_DISCARD);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers_[next]);
  mesh.bind();
  glBeginTransformFeedback(GL_POINTS);
  if (of_ == MeshElement::kFace) {
    mesh.draw_faces(0, count_);
  } else {
    mesh.draw_points();
  }
  glEndTransformFeedback();
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  current_ = next;
}

std::vector<std::uint32_t> MeshSelecting::read() const {
  std::vector<std::uint32_t> out(count_);
  if (count_ > 0) {
    glBindBuffer(GL_TEXTURE_BUFFER, buffers_[current_]);
    glGetBufferSubData(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(count_ * 4), out.data());
  }
  return out;
}

}  // namespace dubsar::ui
