// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/mesh_selecting.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

namespace dubsar::ui {

namespace {

constexpr float kNoiseMm = 0.02F;

/// Numbers of words in, words of BitMarks out. Faces, or vertices, are looked up by number: one invocation
/// for many of them, of which each looks at the neighbours of what those beside it look at, is what makes it
/// fast (bench: 14 times as fast as a geometry shader that makes a number of each face).
constexpr const char* kWord = R"glsl(
uniform mat4 clip_from_model;
uniform int count;            // of elements
uniform samplerBuffer positions;
uniform sampler2D mask;
uniform sampler2D depth_map;
uniform int visible_only;
uniform int step;             // 0 union, 1 intersection, 2 difference
uniform float slack;          // of clip depth
uniform usamplerBuffer before;
uniform int any_before;       // else nothing was selected
flat out uint selected;

vec3 clip_of(vec3 p) { return (clip_from_model * vec4(p, 1.0)).xyz; }

// Clip depth grows away from the eye. What stands within 2 degrees of edge-on shows nothing of its area.
bool is_towards(vec3 n) {
  vec3 away = vec3(clip_from_model[0].z, clip_from_model[1].z, clip_from_model[2].z);
  return dot(away, n) < -0.0349 * length(away) * length(n);
}

bool is_in_polygon(vec3 clip) {
  vec2 at = 0.5 * clip.xy + 0.5;
  return all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))) &&
         textureLod(mask, at, 0.0).r > 0.5;
}

// On a slope the depth of the nearest pixel is another: the deepest of the four around tells.
bool is_seen(vec3 clip) {
  vec4 around = textureGather(depth_map, 0.5 * clip.xy + 0.5);
  float deepest = max(max(around.x, around.y), max(around.z, around.w));
  return 0.5 * (clip.z - slack) + 0.5 <= deepest;
}

bool is_inside(int k);

void main() {
  int first = (gl_VertexID >> 5) * 1024 + (gl_VertexID & 31);
  uint now = 0u;
  for (int k = 0; k < 32 && first + 32 * k < count; ++k) {
    now |= is_inside(first + 32 * k) ? 1u << k : 0u;
  }
  uint was = any_before != 0 ? texelFetch(before, gl_VertexID).r : 0u;
  selected = step == 0 ? (was | now) : step == 1 ? (was & now) : (was & ~now);
}
)glsl";

constexpr const char* kFace = R"glsl(
uniform usamplerBuffer corners;
bool is_inside(int k) {
  uvec3 corner = texelFetch(corners, k).rgb;
  vec3 a = texelFetch(positions, int(corner.x)).rgb;
  vec3 b = texelFetch(positions, int(corner.y)).rgb;
  vec3 c = texelFetch(positions, int(corner.z)).rgb;
  vec3 middle = clip_of((a + b + c) / 3.0);
  return is_in_polygon(middle) &&
         (visible_only == 0 || (is_towards(cross(b - a, c - a)) && is_seen(middle)));
}
)glsl";

constexpr const char* kPoint = R"glsl(
uniform usamplerBuffer normals;   // packed_normal()
float signed10(uint bits) { return float(int(bits << 22) >> 22); }
bool is_inside(int k) {
  vec3 clip = clip_of(texelFetch(positions, k).rgb);
  if (!is_in_polygon(clip)) {
    return false;
  }
  if (visible_only == 0) {
    return true;
  }
  uint bits = texelFetch(normals, k).r;
  vec3 n = vec3(signed10(bits), signed10(bits >> 10), signed10(bits >> 20));
  return (n == vec3(0.0) || is_towards(n)) && is_seen(clip);
}
)glsl";

std::string shader_of(MeshElement of) {
  return std::string("#version 410 core\n") + kWord + (of == MeshElement::kFace ? kFace : kPoint);
}

/// A buffer as a texture that is looked up by number.
void make_readable(GLuint texture, GLenum format, GLuint buffer) {
  glBindTexture(GL_TEXTURE_BUFFER, texture);
  glTexBuffer(GL_TEXTURE_BUFFER, format, buffer);
}

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

MeshSelecting::MeshSelecting(const MeshBuffers& mesh, MeshElement of)
    : program_(shader_of(of).c_str(), nullptr, {"selected"}),
      of_(of),
      count_(of == MeshElement::kFace ? mesh.faces() : mesh.vertices()) {
  glGenVertexArrays(1, &no_vertices_);
  glGenBuffers(2, buffers_);
  glGenTextures(2, textures_);
  for (int k = 0; k < 2; ++k) {
    glBindBuffer(GL_TEXTURE_BUFFER, buffers_[k]);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(std::max<std::size_t>(1, words()) * 4), nullptr,
                 GL_DYNAMIC_COPY);
    make_readable(textures_[k], GL_R32UI, buffers_[k]);
  }
  glGenTextures(2, mesh_textures_);
  make_readable(mesh_textures_[0], GL_RGB32F, mesh.position_buffer());
  if (of == MeshElement::kFace) {
    make_readable(mesh_textures_[1], GL_RGB32UI, mesh.corner_buffer());
  } else {
    make_readable(mesh_textures_[1], GL_R32UI, mesh.normal_buffer());
  }
}

MeshSelecting::~MeshSelecting() {
  glDeleteTextures(2, mesh_textures_);
  glDeleteTextures(2, textures_);
  glDeleteBuffers(2, buffers_);
  glDeleteVertexArrays(1, &no_vertices_);
}

void MeshSelecting::set(SelectionMarks selected) {
  words_.reset();
  selected_ = std::move(selected);
  glBindBuffer(GL_TEXTURE_BUFFER, buffers_[current_]);
  glBufferSubData(GL_TEXTURE_BUFFER, 0,
                  static_cast<GLsizeiptr>(std::min(words(), selected_->words().size()) * 4),
                  selected_->words().data());
}

void MeshSelecting::begin(const OrbitCamera& camera, const std::vector<std::uint8_t>& mask, int width,
                          int height, const FrameTarget* seen, SelectionStep step) {
  mask_.upload(width, height, 1, mask.data(), false);
  if (seen != nullptr) {
    depth_.copy_depth_of(*seen);
  }
  program_.use();
  program_.set("clip_from_model",
               camera.clip_from_model(static_cast<float>(width) / static_cast<float>(height)));
  program_.set("count", static_cast<int>(count_));
  program_.set("mask", 0);
  program_.set("depth_map", 1);
  program_.set("before", 2);
  program_.set("positions", 3);
  program_.set("corners", 4);
  program_.set("normals", 4);
  program_.set("visible_only", seen != nullptr ? 1 : 0);
  program_.set("step", static_cast<int>(step));
  program_.set("any_before", selected_ ? 1 : 0);
  // What is narrower than a pixel may lie deeper than any pixel's middle shows.
  program_.set("slack", (kNoiseMm + camera.mm_per_px(static_cast<float>(height))) / camera.depth_mm);
  words_.emplace();
  words_->reserve(words());
  drawn_ = 0;
}

/// Of those that a call has drawn, the next takes the marks: by then the card is done with them.
bool MeshSelecting::go_on() {
  if (!words_) {
    return false;
  }
  const auto began = std::chrono::steady_clock::now();
  const std::size_t first = words_->size();
  words_->resize(drawn_);
  glBindBuffer(GL_TEXTURE_BUFFER, buffers_[1 - current_]);
  glGetBufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(first * 4),
                     static_cast<GLsizeiptr>((drawn_ - first) * 4), words_->data() + first);
  if (drawn_ == words()) {
    selected_ = std::make_shared<const BitMarks>(count_, std::move(*words_));
    words_.reset();
    current_ = 1 - current_;
    return false;
  }
  const std::size_t count = std::min(BitMarks::words_for(at_a_time_.count()), words() - drawn_);
  draw(count);
  at_a_time_.took(count * 32, std::chrono::steady_clock::now() - began);
  return true;
}

/// The next `count` words of them.
void MeshSelecting::draw(std::size_t count) {
  // Nothing is drawn, but some drivers want a whole frame to not draw into.
  no_picture_.resize(16, 16);
  no_picture_.bind();
  program_.use();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, mask_.id());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth_.width() > 0 ? depth_.depth() : mask_.id());
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_BUFFER, textures_[current_]);
  for (GLuint k = 0; k < 2; ++k) {
    glActiveTexture(GL_TEXTURE3 + k);
    glBindTexture(GL_TEXTURE_BUFFER, mesh_textures_[k]);
  }
  glActiveTexture(GL_TEXTURE0);
  glEnable(GL_RASTERIZER_DISCARD);
  glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers_[1 - current_],
                    static_cast<GLintptr>(drawn_ * 4), static_cast<GLsizeiptr>(count * 4));
  glBindVertexArray(no_vertices_);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, static_cast<GLint>(drawn_), static_cast<GLsizei>(count));
  glEndTransformFeedback();
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  drawn_ += count;
}

}  // namespace dubsar::ui
