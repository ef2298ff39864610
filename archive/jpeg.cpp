// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/jpeg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "formats/jpeg_complaint.h"

namespace dubsar {

namespace {

constexpr double kMmPerInch = 25.4;

/// libjpeg's own memory, to be freed by the caller, whatever happened.
struct Buffer {
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
};

/// The content of an APP1 segment, whose head tells XMP from other things that stand in one.
std::string xmp_segment(const PictureWords& words) {
  using namespace std::string_literals;
  const std::string rdf = rdf_of(words);
  return rdf.empty() ? rdf
                     : "http://ns.adobe.com/xap/1.0/\0"s +
                           "<?xpacket begin=\"\xEF\xBB\xBF\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n"
                           "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">" +
                           rdf + "</x:xmpmeta>\n<?xpacket end=\"r\"?>";
}

bool encode(const Image& image, const std::string& xmp, int quality, Buffer& into, JpegComplaint& complaint) {
  jpeg_compress_struct info{};
  info.err = jpeg_std_error(&complaint.manager);
  complaint.manager.error_exit = JpegComplaint::leave;
  if (setjmp(complaint.back) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &into.bytes, &into.size);
  info.image_width = static_cast<JDIMENSION>(image.width);
  info.image_height = static_cast<JDIMENSION>(image.height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  info.dct_method = JDCT_ISLOW;
  for (int c = 0; c < 3; ++c) {
    info.comp_info[c].h_samp_factor = 1;
    info.comp_info[c].v_samp_factor = 1;
  }
  if (image.mm_per_px > 0) {
    info.density_unit = 1;
    info.X_density = info.Y_density =
        static_cast<UINT16>(std::clamp(std::lround(kMmPerInch / image.mm_per_px), 1L, 65535L));
  }
  jpeg_start_compress(&info, TRUE);
  if (!xmp.empty()) {
    jpeg_write_marker(&info, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(xmp.data()),
                      static_cast<unsigned>(xmp.size()));
  }
  while (info.next_scanline < info.image_height) {
    // libjpeg only reads the row, though it does not say so.
    JSAMPROW row = const_cast<JSAMPROW>(image.bytes.data()) +
                   static_cast<std::size_t>(info.next_scanline) * static_cast<std::size_t>(image.width) * 3;
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image, const PictureWords& words, int quality) {
  if (image.width <= 0 || image.height <= 0 || image.channels != 3 ||
      image.bytes.size() != image.offset(0, image.height)) {
    return fail(ErrorKind::kUsage, "the picture is empty or its size and bytes disagree", "JPEG");
  }
  Buffer buffer;
  JpegComplaint complaint{};
  std::string xmp = xmp_segment(words);
  constexpr std::size_t kLargestSegment = 65533;
  if (xmp.size() > kLargestSegment) {
    xmp = xmp_segment({.title = words.title.substr(0, words.title.find('\n'))});
  }
  const bool done =
      encode(image, xmp.size() <= kLargestSegment ? xmp : std::string(), quality, buffer, complaint);
  std::vector<std::uint8_t> bytes;
  if (done) {
    bytes.assign(buffer.bytes, buffer.bytes + buffer.size);
  }
  std::free(buffer.bytes);
  if (!done) {
    return fail(ErrorKind::kInternal, std::string("libjpeg: ") + complaint.text.data(), "JPEG",
                "take a coarser scale");
  }
  return bytes;
}

}  // namespace dubsar
