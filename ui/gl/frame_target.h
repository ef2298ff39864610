// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <vector>

#include "archive/image.h"

namespace dubsar::ui {

/// How the pixels of a texture are stored.
enum class PixelFormat { kRgba8, kRgba16f, kDepth32f, kR8 };

/// A picture that is drawn into: textures of one size and a depth texture. Grows when asked for another size.
/// Main thread.
class FrameTarget {
 public:
  explicit FrameTarget(std::vector<PixelFormat> colours);
  ~FrameTarget();
  FrameTarget(const FrameTarget&) = delete;
  FrameTarget& operator=(const FrameTarget&) = delete;

  /// Makes it that large; what was drawn is lost when the size changes. True when it did.
  bool resize(int width, int height);
  /// Lets go of its memory; the next resize() takes it again.
  void release();
  /// All that is drawn goes here, until another target or the window is bound.
  void bind() const;
  /// Takes the size and the depths of the other, and leaves it free to be drawn into.
  void copy_depth_of(const FrameTarget& other);
  [[nodiscard]] unsigned colour(int index) const { return colour_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] unsigned depth() const { return depth_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Of the graphics card's memory.
  [[nodiscard]] std::size_t bytes() const;
  /// The first texture, top row first, RGBA.
  [[nodiscard]] Image read() const;

 private:
  std::vector<PixelFormat> formats_;
  std::vector<unsigned> colour_;
  unsigned depth_ = 0;
  unsigned frame_ = 0;
  int width_ = 0;
  int height_ = 0;
};

/// A texture of bytes that a program fills; 0 to `channels` = 1, 3 or 4. Of a picture that is larger than the
/// card's textures every second (third, ...) row and column is in it. Main thread.
class PixelTexture {
 public:
  PixelTexture() = default;
  ~PixelTexture();
  PixelTexture(PixelTexture&& other) noexcept;
  PixelTexture& operator=(PixelTexture&& other) noexcept;
  void upload(int width, int height, int channels, const unsigned char* bytes, bool smooth);
  /// Of what was uploaded before, RGB.
  void put_rows(int first, int count, const unsigned char* bytes) const;
  /// The most rows or columns of which each is in it.
  [[nodiscard]] static int finest();
  [[nodiscard]] unsigned id() const { return id_; }
  /// Of the picture.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Of the graphics card's memory, where three channels take as much as four.
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// What is in the texture of `count` rows that begin with row `first`.
  [[nodiscard]] std::vector<unsigned char> thinned(int first, int count, const unsigned char* bytes) const;

  unsigned id_ = 0;
  int width_ = 0;
  int height_ = 0;
  int channels_ = 0;
  int col_step_ = 1;  ///< of the picture, from one column of the texture to the next
  int row_step_ = 1;
};

/// The pixels of the window's own frame, as they stand, RGB.
[[nodiscard]] Image read_window(int width, int height);

}  // namespace dubsar::ui
