// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Pictures as TIFF and JPEG, read back by the libraries that others use.

#include <gtest/gtest.h>
#include <tiffio.h>

#include <cmath>
#include <fstream>

#include "archive/jpeg.h"
#include "archive/png.h"
#include "archive/tiff.h"
#include "formats/gray_jpeg.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

Image slope(int width, int height) {
  Image image = filled_image(width, height, {0, 0, 0});
  image.mm_per_px = 25.4 / 600;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto grey = static_cast<std::uint8_t>((3 * x + 5 * y) % 256);
      fill_rectangle(image, x, y, 1, 1, {grey, static_cast<std::uint8_t>(255 - grey), 40});
    }
  }
  return image;
}

TEST(Tiff, KeepsEveryPixelAndTheScale) {
  const Image image = slope(301, 707);
  const auto bytes = encode_tiff(image, {.title = "BM 1, fatcross"}, "Dubsar");
  ASSERT_TRUE(bytes) << bytes.error().line();
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.tif";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  TIFF* tiff = TIFFOpen(path.c_str(), "r");
  ASSERT_NE(tiff, nullptr);
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t compression = 0;
  std::uint16_t unit = 0;
  float across = 0;
  char* words = nullptr;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
  TIFFGetField(tiff, TIFFTAG_COMPRESSION, &compression);
  TIFFGetField(tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
  TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &across);
  TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &words);
  EXPECT_EQ(width, 301U);
  EXPECT_EQ(height, 707U);
  EXPECT_EQ(compression, COMPRESSION_LZW);
  EXPECT_EQ(unit, RESUNIT_INCH);
  EXPECT_FLOAT_EQ(across, 600);
  EXPECT_STREQ(words, "BM 1, fatcross");
  std::vector<std::uint8_t> row(3 * 301);
  for (std::uint32_t y = 0; y < height; ++y) {
    ASSERT_EQ(TIFFReadScanline(tiff, row.data(), y), 1);
    ASSERT_TRUE(
        std::equal(row.begin(), row.end(), image.bytes.begin() + static_cast<std::ptrdiff_t>(y) * 903))
        << y;
  }
  TIFFClose(tiff);
  EXPECT_EQ(encode_tiff(image, {.title = "BM 1, fatcross"}, "Dubsar").value(), *bytes);
  EXPECT_EQ(encode_tiff(Image{}, {}, "").error().kind, ErrorKind::kUsage);
}

TEST(Jpeg, SaysHowLargeAPixelIs) {
  const Image image = slope(64, 48);
  const auto bytes = encode_jpeg(image);
  ASSERT_TRUE(bytes) << bytes.error().line();
  // JFIF: unit 1 is dots per inch, then both densities, big endian.
  ASSERT_GT(bytes->size(), 20U);
  EXPECT_EQ((*bytes)[13], 1);
  EXPECT_EQ((*bytes)[14] * 256 + (*bytes)[15], 600);
  EXPECT_EQ((*bytes)[16] * 256 + (*bytes)[17], 600);
  const auto back = parse_gray_jpeg({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, "jpeg");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->width, 64);
  EXPECT_EQ(back->height, 48);
  EXPECT_EQ(encode_jpeg(image).value(), *bytes);
  EXPECT_EQ(encode_jpeg(Image{}).error().kind, ErrorKind::kUsage);
}

TEST(PictureFiles, SayWhatTheyShowAndWhose) {
  const Image image = slope(16, 16);
  const PictureWords words{.title = "BM 1, <obverse>",
                           .description = "SIMULATED: made up\nMuseum number: BM 1 & 2 𒁾",
                           .copyright = "© A Museum"};
  const auto text_of = [](const std::vector<std::uint8_t>& bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const std::string jpeg = text_of(encode_jpeg(image, words).value());
  // APP1 with XMP, after JFIF's APP0.
  EXPECT_EQ(jpeg.substr(20, 2), "\xFF\xE1");
  EXPECT_EQ(jpeg.substr(24, 29), std::string("http://ns.adobe.com/xap/1.0/\0", 29));
  EXPECT_NE(jpeg.find("<dc:title><rdf:Alt><rdf:li xml:lang=\"x-default\">BM 1, &lt;obverse&gt;</rdf:li>"),
            std::string::npos);
  EXPECT_NE(
      jpeg.find("SIMULATED: made up\nMuseum number: BM 1 &amp; 2 𒁾</rdf:li></rdf:Alt></dc:description>"),
      std::string::npos);
  EXPECT_NE(jpeg.find("© A Museum</rdf:li></rdf:Alt></dc:rights>"), std::string::npos);
  EXPECT_EQ(text_of(encode_jpeg(image).value()).find("xap"), std::string::npos);
  PictureWords endless = words;
  endless.description = std::string(70000, 'x');
  EXPECT_LT(encode_jpeg(image, endless).value().size(), jpeg.size()) << "more than a segment holds";
  const std::string tiff = text_of(encode_tiff(image, words, "Dubsar").value());
  EXPECT_NE(tiff.find("BM 1, <obverse>\n" + words.description), std::string::npos);
  EXPECT_NE(tiff.find(words.copyright), std::string::npos);
  const std::string png = text_of(encode_png(image, words).value());
  EXPECT_NE(png.find(std::string("tEXtTitle\0BM 1, <obverse>", 25)), std::string::npos);
  EXPECT_NE(png.find(std::string("iTXtDescription\0\0\0\0\0SIMULATED", 29)), std::string::npos);
  EXPECT_NE(png.find(std::string("iTXtCopyright\0\0\0\0\0", 18) + words.copyright), std::string::npos);
}

}  // namespace
}  // namespace dubsar
