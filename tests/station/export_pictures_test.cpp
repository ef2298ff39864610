// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: its pictures of the six sides show one tablet, each in the light that its folder says.

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <sstream>

#include "formats/mesh_io.h"
#include "tests/station/support/exported.h"

namespace dubsar {
namespace {

using test::bytes_of;
using Pixels = std::vector<std::array<std::uint8_t, 3>>;

struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pixels pixels;
};

Picture read_png(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Picture out;
  if (png_image_begin_read_from_file(&png, file.c_str()) == 0) {
    ADD_FAILURE() << file << ": " << png.message;
    return out;
  }
  png.format = PNG_FORMAT_RGB;
  out = {png.width, png.height, Pixels(std::size_t{png.width} * png.height)};
  EXPECT_NE(png_image_finish_read(&png, nullptr, out.pixels.data(), 0, nullptr), 0) << png.message;
  return out;
}

/// The ground is black.
bool is_clay(const std::array<std::uint8_t, 3>& p) {
  return p != std::array<std::uint8_t, 3>{};
}

double spread(const Picture& picture) {
  double n = 0, sum = 0, squares = 0;
  for (const auto& p : picture.pixels) {
    if (is_clay(p)) {
      const double level = p[1];
      n += 1;
      sum += level;
      squares += level * level;
    }
  }
  return std::sqrt(squares / n - (sum / n) * (sum / n));
}

/// In grey levels, over what either shows as clay.
double difference(const Picture& a, const Picture& b) {
  double n = 0, sum = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) {
    if (is_clay(a.pixels[k]) || is_clay(b.pixels[k])) {
      n += 1;
      sum += std::abs(int{a.pixels[k][1]} - int{b.pixels[k][1]});
    }
  }
  return sum / n;
}

double share_that_one_alone_shows(const Picture& a, const Picture& b) {
  double either = 0, one = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) {
    const bool in_a = is_clay(a.pixels[k]), in_b = is_clay(b.pixels[k]);
    either += in_a || in_b ? 1 : 0;
    one += in_a != in_b ? 1 : 0;
  }
  return one / either;
}

/// The numbers that follow `words`, in a text that may break lines anywhere.
std::vector<double> numbers_after(const std::string& text, const std::string& words, std::size_t count) {
  std::string rest = text.substr(std::min(text.size(), text.find(words) + words.size()));
  for (std::size_t at = rest.find(" to "); at != std::string::npos; at = rest.find(" to ")) {
    rest.replace(at, 4, " ");
  }
  std::istringstream in(rest);
  std::vector<double> out(count, std::nan(""));
  for (double& value : out) {
    in >> value;
  }
  return out;
}

TEST_F(Export, ItsReadmeTellsWhereAPlaceLiesInAPicture) {
  const std::string readme = std::regex_replace(bytes_of(data("README.txt")), std::regex("\\s+"), " ");
  const auto m = numbers_after(readme, "z out of the obverse)", 16);
  const auto e = numbers_after(readme, "In that frame the model reaches from", 6);
  const auto mesh = read_mesh(data("model/session.ply"));
  ASSERT_TRUE(mesh);
  // Of docs/frames-and-units.md: which axis goes right and which up, and whether against it.
  struct Rule {
    const char* picture;
    int r, u;
    double r_sign, u_sign;
  };
  for (const Rule& rule :
       {Rule{"01_top", 0, 2, 1, -1}, Rule{"02_left", 2, 1, 1, 1}, Rule{"03_front", 0, 1, 1, 1},
        Rule{"04_right", 2, 1, -1, 1}, Rule{"05_bottom", 0, 2, 1, 1}, Rule{"06_back", 0, 1, 1, -1}}) {
    const Picture picture = read_png(data("pictures/clay/" + std::string(rule.picture) + ".png"));
    constexpr double kPixelMm = 25.4 / 600;
    std::size_t on_clay = 0;
    for (const Eigen::Vector3f& v : mesh->positions) {
      const auto along = [&](int axis) {
        const auto k = static_cast<std::size_t>(4 * axis);
        return m[k] * v.x() + m[k + 1] * v.y() + m[k + 2] * v.z() + m[k + 3] -
               0.5 * (e[static_cast<std::size_t>(axis)] + e[static_cast<std::size_t>(axis + 3)]);
      };
      const double column = 0.5 * picture.width + rule.r_sign * along(rule.r) / kPixelMm;
      const double row = 0.5 * picture.height - rule.u_sign * along(rule.u) / kPixelMm;
      const double x = std::floor(std::clamp(column, 0.0, picture.width - 1.0));
      const double y = std::floor(std::clamp(row, 0.0, picture.height - 1.0));
      const bool inside = column > -1 && column < picture.width + 1 && row > -1 && row < picture.height + 1;
      on_clay += inside && is_clay(picture.pixels[static_cast<std::size_t>(y * picture.width + x)]) ? 1 : 0;
    }
    // What shows from its inside alone is drawn too; single pixels at the rim may miss the clay.
    EXPECT_GT(static_cast<double>(on_clay), 0.99 * static_cast<double>(mesh->positions.size()))
        << rule.picture;
  }
}

TEST_F(Export, ItsPicturesAreOfOneTabletInFourLights) {
  constexpr std::array<const char*, 4> kLights{"clay", "msii", "ao", "radiance"};
  for (const auto& entry : std::filesystem::directory_iterator(data("pictures/clay"))) {
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    std::array<Picture, kLights.size()> of;
    for (std::size_t k = 0; k < kLights.size(); ++k) {
      of[k] = read_png(data("pictures") / kLights[k] / name);
      ASSERT_EQ(of[k].width, of[0].width) << kLights[k];
      ASSERT_EQ(of[k].height, of[0].height) << kLights[k];
      EXPECT_LT(share_that_one_alone_shows(of[k], of[0]), 0.0001) << kLights[k];
      if (name == "06_back.png") {  // not scanned: what shows of the clay there is its inside, in no light
        EXPECT_LT(spread(of[k]), 1.5) << kLights[k];
        continue;
      }
      EXPECT_GT(spread(of[k]), 5) << kLights[k] << " is of one tone";
      for (std::size_t other = 0; other < k; ++other) {
        EXPECT_GT(difference(of[k], of[other]), 8) << kLights[k] << " and " << kLights[other] << " are alike";
      }
    }
  }
}

}  // namespace
}  // namespace dubsar
