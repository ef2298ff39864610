// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Pictures on the graphics card, larger than its textures, too.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/ui/support/on_a_window.h"
#include "ui/gl/frame_target.h"

namespace dubsar::ui {
namespace {

class PixelTextures : public OnAWindow {
 protected:
  void show() override {}
  /// What is in a texture, RGB; its width and height come first.
  static std::vector<unsigned char> held(const PixelTexture& texture, int& width, int& height) {
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &width);
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &height);
    std::vector<unsigned char> out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGB, GL_UNSIGNED_BYTE, out.data());
    return out;
  }
  /// Rows whose numbers are in their first two channels, `mark` in the third; `cols` alike.
  static std::vector<unsigned char> rows(int first, int count, int cols, unsigned char mark) {
    std::vector<unsigned char> out;
    for (int row = first; row < first + count; ++row) {
      for (int col = 0; col < cols; ++col) {
        for (const int value : {row & 0xff, (row >> 8) & 0xff, int{mark}}) {
          out.push_back(static_cast<unsigned char>(value));
        }
      }
    }
    return out;
  }
};

/// A scan of more rows than the card's textures have: the picture that grows, and thumbnails.
TEST_F(PixelTextures, OfATallPictureEveryFewRowsAreThereAndTheyTakeNewRows) {
  const int total = 2 * PixelTexture::finest() + 10;
  PixelTexture texture;
  texture.upload(2, total, 3, rows(0, total, 2, 1).data(), false);
  EXPECT_EQ(texture.height(), total);
  int width = 0;
  int height = 0;
  std::vector<unsigned char> now = held(texture, width, height);
  ASSERT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  ASSERT_EQ(width, 2);
  ASSERT_EQ(height, (total + 2) / 3);
  EXPECT_EQ(texture.bytes(), static_cast<std::size_t>(height) * 2 * 4);
  const auto number = [&](int row) {
    return now[static_cast<std::size_t>(row) * 6] | now[static_cast<std::size_t>(row) * 6 + 1] << 8;
  };
  for (int row = 0; row < height; ++row) {
    ASSERT_EQ(number(row), 3 * row & 0xffff);
  }
  texture.put_rows(31, 5, rows(31, 5, 2, 2).data());  // of which 33 is there
  texture.put_rows(37, 2, rows(37, 2, 2, 2).data());  // none of which is
  now = held(texture, width, height);
  for (int row = 0; row < height; ++row) {
    ASSERT_EQ(number(row), 3 * row & 0xffff);
    ASSERT_EQ(now[static_cast<std::size_t>(row) * 6 + 2], row == 11 ? 2 : 1) << row;
  }
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(PixelTextures, OfAWidePictureEveryFewColumnsAreThere) {
  const int total = PixelTexture::finest() + 1;
  PixelTexture texture;
  texture.upload(total, 1, 3, rows(0, total, 1, 1).data(), false);
  int width = 0;
  int height = 0;
  const std::vector<unsigned char> now = held(texture, width, height);
  ASSERT_EQ(width, (total + 1) / 2);
  ASSERT_EQ(height, 1);
  EXPECT_EQ(now[static_cast<std::size_t>(width - 1) * 3], static_cast<unsigned char>(2 * (width - 1)));
  EXPECT_EQ(texture.width(), total);
}

}  // namespace
}  // namespace dubsar::ui
