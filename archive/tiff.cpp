// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/tiff.h"

#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace dubsar {

namespace {

constexpr double kMmPerInch = 25.4;
constexpr std::size_t kStripBytes = std::size_t{1} << 18U;

/// A file that lies in memory, as libtiff's callbacks see it.
struct MemoryFile {
  std::vector<std::uint8_t> bytes;
  std::size_t at = 0;
};

tmsize_t read_some(thandle_t handle, void* into, tmsize_t count) {
  auto* file = static_cast<MemoryFile*>(handle);
  const std::size_t left = file->at < file->bytes.size() ? file->bytes.size() - file->at : 0;
  const std::size_t take = std::min(left, static_cast<std::size_t>(count));
  if (take > 0) {
    std::memcpy(into, file->bytes.data() + file->at, take);
    file->at += take;
  }
  return static_cast<tmsize_t>(take);
}

tmsize_t write_some(thandle_t handle, void* from, tmsize_t count) {
  auto* file = static_cast<MemoryFile*>(handle);
  const auto size = static_cast<std::size_t>(count);
  if (file->at + size > file->bytes.size()) {
    file->bytes.resize(file->at + size);
  }
  std::memcpy(file->bytes.data() + file->at, from, size);
  file->at += size;
  return count;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  auto* file = static_cast<MemoryFile*>(handle);
  const std::size_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? file->at : file->bytes.size();
  file->at = from + static_cast<std::size_t>(offset);
  return file->at;
}

int close_nothing(thandle_t) {
  return 0;
}

toff_t size_of(thandle_t handle) {
  return static_cast<MemoryFile*>(handle)->bytes.size();
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_tiff(const Image& image, const PictureWords& words,
                                              const std::string& software) {
  if (image.width <= 0 || image.height <= 0 || image.channels != 3 ||
      image.bytes.size() != image.offset(0, image.height)) {
    return fail(ErrorKind::kUsage, "the picture is empty or its size and bytes disagree", "TIFF");
  }
  MemoryFile memory;
  memory.bytes.reserve(image.bytes.size() / 2);
  // libtiff's own words about errors would go to standard error. Its handlers are the program's, and pictures
  // are encoded side by side: they are set once.
  [[maybe_unused]] static const bool kQuiet = [] {
    TIFFSetErrorHandler(nullptr);
    TIFFSetWarningHandler(nullptr);
    return true;
  }();
  // "l": little endian on every machine.
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(
      TIFFClientOpen("picture.tif", "wl", &memory, read_some, write_some, seek, close_nothing, size_of,
                     nullptr, nullptr),
      [](TIFF* open) {
        if (open != nullptr) {
          TIFFClose(open);
        }
      });
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * 3;
  const auto rows_per_strip = static_cast<std::uint32_t>(std::max<std::size_t>(1, kStripBytes / row_bytes));
  bool good = tiff != nullptr;
  if (good) {
    TIFF* t = tiff.get();
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(image.width));
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(image.height));
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(t, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    TIFFSetField(t, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, rows_per_strip);
    const std::string description = words.title + (words.description.empty() ? "" : "\n") + words.description;
    TIFFSetField(t, TIFFTAG_IMAGEDESCRIPTION, description.c_str());
    if (!words.copyright.empty()) {
      TIFFSetField(t, TIFFTAG_COPYRIGHT, words.copyright.c_str());
    }
    TIFFSetField(t, TIFFTAG_SOFTWARE, software.c_str());
    if (image.mm_per_px > 0) {
      TIFFSetField(t, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
      TIFFSetField(t, TIFFTAG_XRESOLUTION, kMmPerInch / image.mm_per_px);
      TIFFSetField(t, TIFFTAG_YRESOLUTION, kMmPerInch / image.mm_per_px);
    }
    std::vector<std::uint8_t> row(row_bytes);  // the predictor works in place
    for (int y = 0; good && y < image.height; ++y) {
      std::memcpy(row.data(), image.bytes.data() + static_cast<std::size_t>(y) * row_bytes, row_bytes);
      good = TIFFWriteScanline(t, row.data(), static_cast<std::uint32_t>(y), 0) == 1;
    }
    good = good && TIFFFlush(t) == 1;
  }
  if (!good) {
    return fail(ErrorKind::kInternal, "libtiff cannot write the picture", "TIFF", "take a coarser scale");
  }
  return std::move(memory.bytes);
}

}  // namespace dubsar
