// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/gray_jpeg.h"

#include <array>
#include <cstdint>
#include <cstdio>

#include "formats/gray_file.h"
#include "formats/jpeg_complaint.h"

namespace dubsar {

namespace {

/// A warning means bytes that are missing or wrong: as much an error here.
void warn(j_common_ptr info, int level) {
  if (level < 0) {
    JpegComplaint::leave(info);
  }
}

bool decode(std::string_view bytes, GrayImage& image, JpegComplaint& complaint) {
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&complaint.manager);
  complaint.manager.error_exit = JpegComplaint::leave;
  complaint.manager.emit_message = warn;
  if (setjmp(complaint.back) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (static_cast<std::uint64_t>(info.image_width) * info.image_height >
      static_cast<std::uint64_t>(kMostImagePixels)) {
    std::snprintf(complaint.text.data(), complaint.text.size(), "it is larger than %d pixels",
                  kMostImagePixels);
    jpeg_destroy_decompress(&info);
    return false;
  }
  info.out_color_space = JCS_GRAYSCALE;
  info.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&info);
  image.width = static_cast<int>(info.output_width);
  image.height = static_cast<int>(info.output_height);
  image.pixels.resize(static_cast<std::size_t>(info.output_width) * info.output_height);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = image.pixels.data() + static_cast<std::size_t>(info.output_scanline) * info.output_width;
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return true;
}

}  // namespace

Result<GrayImage> parse_gray_jpeg(std::string_view bytes, const std::string& where) {
  GrayImage image;
  JpegComplaint complaint{};
  if (!decode(bytes, image, complaint)) {
    return bad_input(where, std::string("the picture cannot be read: ") + complaint.text.data(),
                     "give a whole picture");
  }
  return image;
}

}  // namespace dubsar
