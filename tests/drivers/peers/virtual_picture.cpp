// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/drivers/peers/virtual_picture.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>  // wants cstdio before it

namespace dubsar::test {

std::uint32_t picture_line_bytes(std::uint32_t fourcc, std::uint32_t width) {
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
    case V4L2_PIX_FMT_MJPEG:
      return width;
    case V4L2_PIX_FMT_RGB24:
      return 3 * width;
    default:  // Y10 ... Y16, YUYV
      return 2 * width;
  }
}

void paint_picture(std::vector<std::uint8_t>& picture, std::uint32_t fourcc, std::uint32_t width,
                   std::uint32_t height, std::uint32_t sequence, std::uint32_t corner) {
  const std::size_t size = std::size_t{picture_line_bytes(fourcc, width)} * height;
  const std::size_t wide = picture_line_bytes(fourcc, width) / width;
  const std::size_t bright = fourcc == V4L2_PIX_FMT_YUYV ? 1 : wide;
  if (picture.size() != size) {
    picture.assign(size, 0x80);
    for (std::size_t y = 0; y < height; ++y) {
      for (std::size_t x = 0; x < width; ++x) {
        std::fill_n(picture.begin() + static_cast<std::ptrdiff_t>((y * width + x) * wide), bright,
                    static_cast<std::uint8_t>(corner + 7 * x + 3 * y));
      }
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    std::fill_n(picture.begin() + static_cast<std::ptrdiff_t>(k * wide), bright,
                static_cast<std::uint8_t>(sequence >> (8 * k)));
  }
}

std::vector<std::uint8_t> packed_picture(const std::vector<std::uint8_t>& grey, std::uint32_t width,
                                         std::uint32_t height) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct info{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT: libjpeg's type
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = width;
  info.image_height = height;
  info.input_components = 3;
  info.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 96, TRUE);
  info.comp_info[0].h_samp_factor = 2;
  info.comp_info[0].v_samp_factor = 1;
  jpeg_suppress_tables(&info, FALSE);
  for (int k = 0; k < 2; ++k) {  // said to be known to whoever reads it
    info.dc_huff_tbl_ptrs[k]->sent_table = TRUE;
    info.ac_huff_tbl_ptrs[k]->sent_table = TRUE;
  }
  jpeg_start_compress(&info, FALSE);
  std::vector<std::uint8_t> line(std::size_t{3} * width, 0x80);
  while (info.next_scanline < height) {
    const std::uint8_t* const from = grey.data() + std::size_t{info.next_scanline} * width;
    for (std::size_t x = 0; x < width; ++x) {
      line[3 * x] = from[x];
    }
    JSAMPROW row = line.data();
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  std::vector<std::uint8_t> out(bytes, bytes + size);
  jpeg_destroy_compress(&info);
  std::free(bytes);  // NOLINT: libjpeg took it so
  return out;
}

}  // namespace dubsar::test
