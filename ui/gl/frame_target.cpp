// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/gl/frame_target.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

namespace dubsar::ui {

namespace {

struct Pixels {
  GLint internal;
  GLenum format;
  GLenum type;
};

Pixels pixels_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case PixelFormat::kRgba16f:
      return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case PixelFormat::kR8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case PixelFormat::kDepth32f:
      break;
  }
  return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
}

GLuint new_texture(PixelFormat format, int width, int height) {
  const Pixels pixels = pixels_of(format);
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, pixels.internal, width, height, 0, pixels.format, pixels.type, nullptr);
  const GLint filter = format == PixelFormat::kRgba8 ? GL_LINEAR : GL_NEAREST;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return id;
}

/// How many of `count` there are when every step-th is taken, from the first.
int taken(int count, int step) {
  return (count + step - 1) / step;
}

/// OpenGL's first row is the lowest.
void flip_rows(Image& image) {
  const auto row = static_cast<std::ptrdiff_t>(image.width) * image.channels;
  for (int y = 0; y < image.height / 2; ++y) {
    std::swap_ranges(image.bytes.begin() + y * row, image.bytes.begin() + (y + 1) * row,
                     image.bytes.begin() + (image.height - 1 - y) * row);
  }
}

}  // namespace

FrameTarget::FrameTarget(std::vector<PixelFormat> colours) : formats_(std::move(colours)) {}

FrameTarget::~FrameTarget() {
  release();
}

void FrameTarget::release() {
  glDeleteTextures(static_cast<GLsizei>(colour_.size()), colour_.data());
  glDeleteTextures(1, &depth_);
  glDeleteFramebuffers(1, &frame_);
  colour_.clear();
  depth_ = frame_ = 0;
  width_ = height_ = 0;
}

bool FrameTarget::resize(int width, int height) {
  width = std::max(1, width);
  height = std::max(1, height);
  if (width == width_ && height == height_) {
    return false;
  }
  release();
  width_ = width;
  height_ = height;
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  std::vector<GLenum> drawn;
  for (const PixelFormat format : formats_) {
    colour_.push_back(new_texture(format, width, height));
    drawn.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(drawn.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, drawn.back(), GL_TEXTURE_2D, colour_.back(), 0);
  }
  depth_ = new_texture(PixelFormat::kDepth32f, width, height);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
  if (drawn.empty()) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  } else {
    glDrawBuffers(static_cast<GLsizei>(drawn.size()), drawn.data());
  }
  return true;
}

std::size_t FrameTarget::bytes() const {
  std::size_t each = 4;  // the depth
  for (const PixelFormat format : formats_) {
    each += format == PixelFormat::kRgba16f ? 8 : format == PixelFormat::kR8 ? 1 : 4;
  }
  return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * each;
}

void FrameTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, width_, height_);
}

void FrameTarget::copy_depth_of(const FrameTarget& other) {
  resize(other.width_, other.height_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, other.frame_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frame_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Image FrameTarget::read() const {
  Image image;
  image.width = width_;
  image.height = height_;
  image.channels = 4;
  image.bytes.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.bytes.data());
  flip_rows(image);
  return image;
}

PixelTexture::~PixelTexture() {
  glDeleteTextures(1, &id_);
}

PixelTexture::PixelTexture(PixelTexture&& other) noexcept
    : id_(std::exchange(other.id_, 0U)),
      width_(other.width_),
      height_(other.height_),
      channels_(other.channels_),
      col_step_(other.col_step_),
      row_step_(other.row_step_) {}

PixelTexture& PixelTexture::operator=(PixelTexture&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(width_, other.width_);
  std::swap(height_, other.height_);
  std::swap(channels_, other.channels_);
  std::swap(col_step_, other.col_step_);
  std::swap(row_step_, other.row_step_);
  return *this;
}

void PixelTexture::upload(int width, int height, int channels, const unsigned char* bytes, bool smooth) {
  const GLenum format = channels == 1 ? GL_RED : channels == 3 ? GL_RGB : GL_RGBA;
  const GLint internal = channels == 1 ? GL_R8 : channels == 3 ? GL_RGB8 : GL_RGBA8;
  if (id_ == 0) {
    glGenTextures(1, &id_);
  }
  width_ = width;
  height_ = height;
  channels_ = channels;
  col_step_ = taken(width, finest());
  row_step_ = taken(height, finest());
  std::vector<unsigned char> fewer;
  if (col_step_ > 1 || row_step_ > 1) {
    fewer = thinned(0, height, bytes);
    bytes = fewer.data();
  }
  glBindTexture(GL_TEXTURE_2D, id_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, internal, taken(width, col_step_), taken(height, row_step_), 0, format,
               GL_UNSIGNED_BYTE, bytes);
  const GLint filter = smooth ? GL_LINEAR : GL_NEAREST;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

int PixelTexture::finest() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  return std::max(1, most);
}

std::vector<unsigned char> PixelTexture::thinned(int first, int count, const unsigned char* bytes) const {
  const auto each = static_cast<std::size_t>(channels_);
  const std::size_t row_bytes = static_cast<std::size_t>(width_) * each;
  std::vector<unsigned char> out;
  for (int row = taken(first, row_step_) * row_step_; row < first + count; row += row_step_) {
    const unsigned char* from = bytes + static_cast<std::size_t>(row - first) * row_bytes;
    for (std::size_t at = 0; at < row_bytes; at += static_cast<std::size_t>(col_step_) * each) {
      out.insert(out.end(), from + at, from + at + each);
    }
  }
  return out;
}

std::size_t PixelTexture::bytes() const {
  const std::size_t each = channels_ > 1 ? 4 : 1;
  return static_cast<std::size_t>(taken(width_, col_step_)) *
         static_cast<std::size_t>(taken(height_, row_step_)) * each;
}

void PixelTexture::put_rows(int first, int count, const unsigned char* bytes) const {
  glBindTexture(GL_TEXTURE_2D, id_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const int above = taken(first, row_step_);  // rows of the texture
  const int rows = taken(first + count, row_step_) - above;
  std::vector<unsigned char> fewer;
  if (col_step_ > 1 || row_step_ > 1) {
    fewer = thinned(first, count, bytes);
    bytes = fewer.data();
  }
  if (rows > 0) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, above, taken(width_, col_step_), rows, GL_RGB, GL_UNSIGNED_BYTE,
                    bytes);
  }
}

Image read_window(int width, int height) {
  Image image = filled_image(width, height, {0, 0, 0});
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.bytes.data());
  flip_rows(image);
  return image;
}

}  // namespace dubsar::ui
