// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export: its pictures of the six sides show one tablet, each in the light that its folder says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "acquisition/session_store.h"
#include "formats/mesh_io.h"
#include "formats/sha2.h"
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

/// Without the rows of its scale bar (docs/frames-and-units.md).
Picture read_side(const std::filesystem::path& file) {
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
  constexpr std::uint32_t kBarRows = 72;
  EXPECT_GT(out.height, kBarRows) << file;
  out.height -= std::min(out.height, kBarRows);
  const auto bar = out.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{out.width} * out.height);
  const bool inked = std::any_of(bar, out.pixels.end(), [](const auto& p) { return p[0] > 200; });
  EXPECT_TRUE(inked || out.width * 25.4 / 600 < 3) << file << ": no bar";
  out.pixels.erase(bar, out.pixels.end());
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

/// The numbers that follow `words`.
std::vector<double> numbers_after(const std::string& text, const std::string& words, std::size_t count) {
  const std::size_t at = text.find(words);
  std::istringstream in(at == std::string::npos ? "" : text.substr(at + words.size()));
  std::vector<double> out(count, std::nan(""));
  for (double& value : out) {
    in >> value;
  }
  return out;
}

/// At its rim a surface covers less than half of some pixels.
bool clay_within_a_pixel(const Picture& picture, int column, int row) {
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, int(picture.height) - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, int(picture.width) - 1); ++x) {
      if (is_clay(
              picture.pixels[static_cast<std::size_t>(y) * picture.width + static_cast<std::size_t>(x)])) {
        return true;
      }
    }
  }
  return false;
}

struct Correlation {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  void add(double a, double b) { n += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b; }
  [[nodiscard]] double value() const {
    return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
  }
};

TEST_F(Export, ItsReadmeTellsWhereAPlaceLiesInAPicture) {
  // Lines break anywhere, and extents are told as "from … to …".
  const std::string readme =
      std::regex_replace(bytes_of(data("README.txt")), std::regex("\\s+(to\\s+)?"), " ");
  const auto m = numbers_after(readme, "z out of the obverse)", 16);
  const auto e = numbers_after(readme, "In that frame the model reaches from", 6);
  const auto mesh = read_mesh(data("model/session.ply"));
  ASSERT_TRUE(mesh);
  const std::string values = bytes_of(data("features/msii.mat"));
  const auto msii = numbers_after(values, values.substr(0, values.find("\n0 ")), 2 * mesh->positions.size());
  // Of docs/frames-and-units.md: which axis goes right and which up, and whether against it.
  struct Rule {
    const char* picture;
    int r, u;
    double r_sign, u_sign;
  };
  for (const Rule& rule :
       {Rule{"01_top", 0, 2, 1, -1}, Rule{"02_left", 2, 1, 1, 1}, Rule{"03_front", 0, 1, 1, 1},
        Rule{"04_right", 2, 1, -1, 1}, Rule{"05_bottom", 0, 2, 1, 1}, Rule{"06_back", 0, 1, 1, -1}}) {
    const Picture picture = read_side(data("pictures/clay") / (std::string(rule.picture) + ".png"));
    const Picture hollows = read_side(data("pictures/msii") / (std::string(rule.picture) + ".png"));
    constexpr double kPixelMm = 25.4 / 600;
    std::size_t missed = 0;
    Correlation hollow_is_dark;
    for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
      const Eigen::Vector3f& v = mesh->positions[i];
      const auto along = [&](int axis) {
        const auto k = static_cast<std::size_t>(4 * axis);
        return m[k] * v.x() + m[k + 1] * v.y() + m[k + 2] * v.z() + m[k + 3] -
               0.5 * (e[static_cast<std::size_t>(axis)] + e[static_cast<std::size_t>(axis + 3)]);
      };
      const auto column =
          static_cast<int>(std::floor(0.5 * picture.width + rule.r_sign * along(rule.r) / kPixelMm));
      const auto row =
          static_cast<int>(std::floor(0.5 * picture.height - rule.u_sign * along(rule.u) / kPixelMm));
      missed += clay_within_a_pixel(picture, column, row) ? 0 : 1;
      if (column >= 0 && column < int(picture.width) && row >= 0 && row < int(picture.height)) {
        const auto at = static_cast<std::size_t>(row) * picture.width + static_cast<std::size_t>(column);
        // At the rim of a sheet the spheres reach past it, and the tones end before the values do.
        const bool inner = std::max(std::abs(along(0)), std::abs(along(1))) < 12.5;
        if (inner && is_clay(picture.pixels[at])) {
          hollow_is_dark.add(msii[2 * i + 1], hollows.pixels[at][1]);
        }
      }
    }
    EXPECT_EQ(missed, 0U) << rule.picture;
    if (rule.picture == std::string_view("03_front")) {  // the one side that was scanned
      EXPECT_LT(hollow_is_dark.value(), -0.99);
    }
  }
}

TEST_F(Export, ItsPicturesAreOfOneTabletInFourLights) {
  constexpr std::array<const char*, 4> kLights{"clay", "msii", "ao", "radiance"};
  for (const auto& entry : std::filesystem::directory_iterator(data("pictures/clay"))) {
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    std::array<Picture, kLights.size()> of;
    for (std::size_t k = 0; k < kLights.size(); ++k) {
      of[k] = read_side(data("pictures") / kLights[k] / name);
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

using ExportOfALargeTablet = ExportOfACopy;

TEST_F(ExportOfALargeTablet, ThatFitsIntoNoPictureIsPackedWithoutThem) {
  {
    // The session's mesh, 60 times as large: some 1.7 m. Its record is that of the mesh again.
    SessionStore store = SessionStore::open(session_).value();
    Mesh mesh = read_mesh(session_ / "mesh/model.ply").value();
    for (Eigen::Vector3f& p : mesh.positions) {
      p *= 60.0F;
    }
    ASSERT_TRUE(store.replace_file(
        "mesh/model.ply", [&](const std::filesystem::path& file) { return write_mesh(file, mesh); }));
    nlohmann::json model = nlohmann::json::parse(store.load_document("model").value().value());
    model["sha256"] = sha256_hex(bytes_of(session_ / "mesh/model.ply"));
    ASSERT_TRUE(store.save_document("model", model.dump()));
  }
  const test::Outcome done = pack_without("wedges,features,grid-ply", {});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.json()["lacking"].dump(),
              ::testing::HasSubstr("Pictures of the six sides: the tablet is too large for them"));
  EXPECT_FALSE(std::filesystem::exists(bag() / "data/pictures"));
  EXPECT_THAT(readme(), ::testing::Not(::testing::HasSubstr("pictures/fatcross/")));
  EXPECT_EQ(test::run_command({"verify", bag().string()}).status, 0);
}

}  // namespace
}  // namespace dubsar
