// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/mjpeg.h"

#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>

#include <jpeglib.h>  // wants cstdio before it

#include <jerror.h>

namespace dubsar::v4l2 {

namespace {

/// libjpeg reports by a jump: nothing with a destructor may live between it and where it lands.
struct Complaint {
  jpeg_error_mgr manager;
  std::jmp_buf back;
  std::array<char, JMSG_LENGTH_MAX> text;

  static void leave(j_common_ptr info) {
    auto* complaint = reinterpret_cast<Complaint*>(info->err);
    (*info->err->format_message)(info, complaint->text.data());
    std::longjmp(complaint->back, 1);
  }
  /// A warning means pixels that are missing or made up, but for bytes too many.
  static void warn(j_common_ptr info, int level) {
    if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) {
      leave(info);
    }
  }
};

bool decode(std::span<const std::uint8_t> picture, std::uint32_t width, std::uint32_t height,
            std::uint8_t* pixels, Complaint& complaint) {
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&complaint.manager);
  complaint.manager.error_exit = Complaint::leave;
  complaint.manager.emit_message = Complaint::warn;
  if (setjmp(complaint.back) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, picture.data(), picture.size());
  jpeg_read_header(&info, TRUE);
  if (info.image_width != width || info.image_height != height) {
    std::snprintf(complaint.text.data(), complaint.text.size(), "a picture of %ux%u", info.image_width,
                  info.image_height);
    jpeg_destroy_decompress(&info);
    return false;
  }
  info.out_color_space = JCS_GRAYSCALE;
  info.dct_method = JDCT_ISLOW;  // the others round by up to a grey value more
  jpeg_start_decompress(&info);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = pixels + std::size_t{info.output_scanline} * width;
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return true;
}

}  // namespace

bool decode_luma(std::span<const std::uint8_t> picture, std::uint32_t width, std::uint32_t height,
                 std::span<std::uint8_t> pixels, std::string& why) {
  why.clear();
  if (picture.empty() || pixels.size() < std::size_t{width} * height) {
    why = picture.empty() ? "no picture" : "no room for the picture";
    return false;
  }
  Complaint complaint{};
  const bool whole = decode(picture, width, height, pixels.data(), complaint);
  if (!whole) {
    why = complaint.text.data();
  }
  return whole;
}

}  // namespace dubsar::v4l2
