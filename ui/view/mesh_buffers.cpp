// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/mesh_buffers.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "ui/gl/card_memory.h"

namespace dubsar::ui {

namespace {

// Places of the attributes in the shaders.
constexpr GLuint kPosition = 0;
constexpr GLuint kNormal = 1;
constexpr GLuint kTraits = 2;
constexpr GLuint kValue = 3;
constexpr GLuint kColour = 4;

/// Of a frame's time, and between two looks at the clock.
constexpr std::chrono::milliseconds kUploadFor{30};
constexpr std::size_t kUploadAtOnce = std::size_t{4} << 20U;

GLuint new_buffer(GLenum target, std::size_t bytes, const void* data) {
  GLuint id = 0;
  glGenBuffers(1, &id);
  glBindBuffer(target, id);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
  return id;
}

/// A place in the bound buffer, as OpenGL wants it.
const void* at_offset(std::uintptr_t bytes) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset in a pointer's clothes; it is never followed
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

MeshBuffers::MeshBuffers(const ShownMesh& mesh)
    : vertices_(mesh.positions.size()),
      faces_(mesh.faces.size()),
      has_colours_(!mesh.colours.empty()),
      whole_(mesh.instead_of_faces == 0) {
  static_cast<void>(card_has_refused());  // what was refused before is no concern of this mesh
  const auto add = [&](GLenum target, std::size_t bytes) {
    GLuint& buffer = buffers_.emplace_back();
    glGenBuffers(1, &buffer);
    glBindBuffer(target, buffer);
    rooms_.push_back({buffer, bytes});
    bytes_ += bytes;
    return buffer;
  };
  const auto put = [&](GLuint buffer, std::size_t at, const auto& of) {
    parts_.push_back({buffer, at, reinterpret_cast<const std::byte*>(of.data()), of.size() * sizeof(of[0])});
  };
  glGenVertexArrays(1, &array_);
  glBindVertexArray(array_);
  const auto attribute = [&](GLuint place, GLint size, GLenum type, GLboolean normalised, const auto& of) {
    put(add(GL_ARRAY_BUFFER, of.size() * sizeof(of[0])), 0, of);
    if (!of.empty()) {
      glEnableVertexAttribArray(place);
      glVertexAttribPointer(place, size, type, normalised, 0, nullptr);
    }
  };
  attribute(kPosition, 3, GL_FLOAT, GL_FALSE, mesh.positions);
  attribute(kNormal, 4, GL_INT_2_10_10_10_REV, GL_TRUE, mesh.normals);
  attribute(kTraits, 4, GL_UNSIGNED_BYTE, GL_TRUE, mesh.traits);
  add(GL_ARRAY_BUFFER, vertices_ * sizeof(float));  // kValue: set_values() must not find the card full
  attribute(kColour, 3, GL_UNSIGNED_BYTE, GL_TRUE, mesh.colours);
  std::size_t coarser = 0;
  for (const ShownLevel& level : mesh.coarser) {
    level_first_.push_back(coarser);
    coarser += level.detail.faces.size();
  }
  // One buffer for the faces of all levels, the whole surface first.
  corner_buffer_ = add(GL_ELEMENT_ARRAY_BUFFER, (faces_ + coarser) * 12);
  made_of_buffer_ = add(GL_TEXTURE_BUFFER, coarser * 4);
  put(corner_buffer_, 0, mesh.faces);
  for (std::size_t k = 0; k < mesh.coarser.size(); ++k) {
    const DetailLevel& level = mesh.coarser[k].detail;
    put(corner_buffer_, (faces_ + level_first_[k]) * 12, level.faces);
    put(made_of_buffer_, level_first_[k] * 4, level.from);
  }
  glGenTextures(1, &made_of_);
  glBindVertexArray(0);
}

void MeshBuffers::take_room(const Room& room) const {
  glBindBuffer(GL_COPY_WRITE_BUFFER, room.buffer);
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(room.bytes), nullptr, GL_STATIC_DRAW);
  if (room.buffer == made_of_buffer_) {
    glBindTexture(GL_TEXTURE_BUFFER, made_of_);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, made_of_buffer_);
  }
}

void MeshBuffers::upload() {
  const auto began = std::chrono::steady_clock::now();
  while (!is_uploaded() && std::chrono::steady_clock::now() - began < kUploadFor) {
    if (!rooms_.empty()) {
      take_room(rooms_.back());
      rooms_.pop_back();
      continue;
    }
    Part& part = parts_.back();
    const std::size_t bytes = std::min(part.bytes, kUploadAtOnce);
    if (bytes > 0) {
      glBindBuffer(GL_COPY_WRITE_BUFFER, part.buffer);
      glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(part.at), static_cast<GLsizeiptr>(bytes),
                      part.data);
    }
    part.at += bytes;
    part.data += bytes;
    part.bytes -= bytes;
    if (part.bytes == 0) {
      parts_.pop_back();
    }
  }
  refused_ = card_has_refused();
}

MeshBuffers::~MeshBuffers() {
  glDeleteVertexArrays(1, &array_);
  glDeleteTextures(1, &made_of_);
  glDeleteBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
}

void MeshBuffers::set_values(const std::vector<float>& values) {
  has_values_ = values.size() == vertices_ && vertices_ > 0;
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[kValue]);
  if (has_values_) {
    glEnableVertexAttribArray(kValue);
    glVertexAttribPointer(kValue, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  } else {
    glDisableVertexAttribArray(kValue);
  }
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(has_values_ ? vertices_ * sizeof(float) : 0),
                  values.data());
  glBindVertexArray(0);
}

void MeshBuffers::set_traits(const std::vector<std::array<std::uint8_t, 4>>& traits) {
  if (traits.size() == vertices_) {
    glBindBuffer(GL_ARRAY_BUFFER, buffers_[kTraits]);
    glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(vertices_ * 4), traits.data());
  }
}

unsigned MeshBuffers::position_buffer() const {
  return buffers_[kPosition];
}

unsigned MeshBuffers::normal_buffer() const {
  return buffers_[kNormal];
}

void MeshBuffers::bind() const {
  glBindVertexArray(array_);
  glVertexAttrib3f(kColour, 1, 1, 1);
  glVertexAttrib1f(kValue, 0);
}

void MeshBuffers::draw_faces(std::size_t first, std::size_t count) const {
  const std::uintptr_t offset = first * 12;
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * count), GL_UNSIGNED_INT, at_offset(offset));
}

void MeshBuffers::draw_level(std::size_t level, std::size_t first, std::size_t count) const {
  draw_faces(faces_ + level_first_[level] + first, count);
}

void MeshBuffers::draw_points(std::size_t first, std::size_t count) const {
  glDrawArrays(GL_POINTS, static_cast<GLint>(first), static_cast<GLsizei>(count));
}

PointBuffers::PointBuffers(const ColouredPoints& points)
    : count_(points.positions_mm.size()), radius_mm_(points.radius_mm), bury_mm_(points.bury_mm) {
  struct Vertex {
    float position[3];
    std::uint32_t normal;
    std::uint8_t excused[4];
  };
  std::vector<Vertex> vertices(count_);
  for (std::size_t k = 0; k < count_; ++k) {
    Vertex& v = vertices[k];
    std::memcpy(v.position, points.positions_mm[k].data(), sizeof v.position);
    v.normal = k < points.normals.size() ? packed_normal(points.normals[k]) : 0U;
    const bool amber = k < points.colours.size() && points.colours[k] == kAmberOfExcused;
    v.excused[0] = amber ? 255 : 0;
  }
  glGenVertexArrays(1, &array_);
  glBindVertexArray(array_);
  bytes_ = count_ * sizeof(Vertex);
  buffer_ = new_buffer(GL_ARRAY_BUFFER, bytes_, vertices.data());
  const auto attribute = [](GLuint place, GLint size, GLenum type, GLboolean normalised,
                            std::uintptr_t offset) {
    glEnableVertexAttribArray(place);
    glVertexAttribPointer(place, size, type, normalised, sizeof(Vertex), at_offset(offset));
  };
  attribute(kPosition, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
  attribute(kNormal, 4, GL_INT_2_10_10_10_REV, GL_TRUE, offsetof(Vertex, normal));
  attribute(kTraits, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, excused));
  glBindVertexArray(0);
}

PointBuffers::~PointBuffers() {
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &buffer_);
}

void PointBuffers::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count_));
  glBindVertexArray(0);
}

}  // namespace dubsar::ui
