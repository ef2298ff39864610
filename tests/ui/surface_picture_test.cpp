// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The shadings against stored pictures of the same surface. DUBSAR_KEEP_PICTURES=FOLDER keeps what is drawn
// now: look at it before it becomes the stored one.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "build_paths.h"
#include "station/picture_file.h"
#include "tests/support/raster_mesh.h"
#include "tests/ui/support/on_a_window.h"
#include "tests/ui/support/read_png.h"
#include "ui/view/piece_size.h"
#include "ui/view/still_picture.h"

namespace dubsar::ui {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 240;
constexpr int kHeight = 180;

/// Of the slab with two wedge-like dents and a bump.
float slab_height_mm(float x, float y) {
  const auto dent = [](float dx, float dy, float depth) {
    return std::max(0.0F, depth - 0.9F * std::abs(dy) - 0.35F * std::abs(dx - 0.4F * dx * dx / 3));
  };
  const float bump = 1.2F * std::exp(-((x - 5) * (x - 5) + (y + 3) * (y + 3)) / 3);
  return -0.015F * (x * x + y * y) - dent(x + 4, y - 2, 1.5F) - dent(x - 2, y - 3, 1.0F) + bump;
}

Mesh dented_slab(std::uint32_t cells = 220) {
  const auto side = static_cast<float>(cells);
  Mesh mesh;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float x = -10 + 20 * static_cast<float>(i) / side;
      const float y = -7.5F + 15 * static_cast<float>(j) / side;
      mesh.positions.emplace_back(x, y, slab_height_mm(x, y));
      mesh.flags.push_back(i > cells - 20 ? std::uint8_t{kVertexSparse} : std::uint8_t{0});
    }
  }
  test::add_raster_faces(mesh, 0, cells);
  return mesh;
}

class Shading : public OnAWindow {
 protected:
  void show() override {
    const Mesh mesh = dented_slab();
    const ShownMesh shown = shown_mesh(mesh);
    view_->show(shown);
    std::vector<float> heights;
    for (const auto& p : mesh.positions) {
      heights.push_back(p.z());
    }
    view_->set_values(heights);
    camera_.eye_from_model = Eigen::AngleAxisf(-0.5F, Eigen::Vector3f::UnitX());
    camera_.fit(shown.box_mm, static_cast<float>(kWidth) / kHeight);
    look_.ground = {0.1F, 0.1F, 0.12F, 1};
  }
  void expect_as_stored(const std::string& name) {
    view_->draw_whole(camera_, look_, kWidth, kHeight);
    const Image drawn = view_->read();
    if (const char* folder = std::getenv("DUBSAR_KEEP_PICTURES"); folder != nullptr) {
      ASSERT_TRUE(write_picture(fs::path(folder) / (name + ".png"), drawn, {.title = name}));
    }
    const Image stored = test::read_png(fs::path(DUBSAR_SOURCE_DIR) / "tests/ui/pictures" / (name + ".png"));
    ASSERT_EQ(stored.bytes.size(), drawn.bytes.size()) << name;
    double sum = 0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < stored.bytes.size(); ++i) {
      const int apart = std::abs(static_cast<int>(stored.bytes[i]) - static_cast<int>(drawn.bytes[i]));
      sum += apart;
      far += apart > 40 ? 1 : 0;
    }
    // Another driver rounds otherwise and its edges fall otherwise; light from another side is far beyond
    // this.
    EXPECT_LT(sum / static_cast<double>(stored.bytes.size()), 2.0) << name;
    EXPECT_LT(static_cast<double>(far) / static_cast<double>(stored.bytes.size()), 0.01) << name;
  }

  OrbitCamera camera_;
  Look look_;
};

TEST_F(Shading, LitSphere) {
  expect_as_stored("lit_sphere");
}

TEST_F(Shading, RakingLampWithShadows) {
  look_.lamp = true;
  look_.light = {-0.9F, 0.3F, 0.35F};
  expect_as_stored("raking");
}

TEST_F(Shading, OverlayOfNumbers) {
  look_.overlay = Overlay::kValue;
  look_.value_range = {-2, 1};
  look_.radiance = 0;
  expect_as_stored("values");
}

TEST_F(Shading, SparseVerticesAndDepthShading) {
  look_.overlay = Overlay::kFlags;
  look_.depth_shading = 1.5F;
  expect_as_stored("sparse_depth");
}

/// Each level of detail against the whole surface, at the zoom that it is there for.
TEST_F(Shading, LevelsOfDetailLookLikeTheWholeSurfaceWithoutCracks) {
  const ShownMesh shown = shown_mesh(dented_slab(900));  // 1.6 million faces
  view_->show(shown);
  ASSERT_EQ(view_->levels(), 3U);
  camera_.centre_mm = {0, 1, 0};
  for (const auto& [zoom, level] : {std::pair{1, 0U}, {2, 1U}, {4, 1U}}) {
    OrbitCamera camera = camera_;
    camera.half_height_mm /= static_cast<float>(zoom);
    const std::size_t most = view_->faces_in_motion();
    view_->draw(camera, look_, kWidth, kHeight);
    EXPECT_LE(view_->faces_drawn(), most) << "zoom " << zoom;
    if (most >= 3 * kFacesInMotion) {  // not yet found slow
      EXPECT_GE(view_->level_drawn(), level) << "zoom " << zoom;
    }
    view_->draw_level(level, camera, look_, kWidth, kHeight);
    const Image rough = view_->read();
    view_->draw_whole(camera, look_, kWidth, kHeight);
    const Image whole = view_->read();
    if (const char* folder = std::getenv("DUBSAR_KEEP_PICTURES"); folder != nullptr) {
      const std::string name = "level_" + std::to_string(level) + "_zoom_" + std::to_string(zoom) + ".png";
      ASSERT_TRUE(write_picture(fs::path(folder) / name, rough, {.title = name}));
    }
    double sum = 0;
    std::size_t cracks = 0;
    for (std::size_t i = 0; i < whole.bytes.size(); i += 4) {
      const auto is_ground = [&](const Image& picture) {
        return picture.bytes[i] < 30 && picture.bytes[i + 1] < 30 && picture.bytes[i + 2] > 28 &&
               picture.bytes[i + 2] < 34;
      };
      cracks += is_ground(rough) && !is_ground(whole) ? 1 : 0;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += std::abs(static_cast<int>(whole.bytes[i + k]) - static_cast<int>(rough.bytes[i + k]));
      }
    }
    EXPECT_LT(sum / static_cast<double>(3 * whole.bytes.size() / 4), 6.0) << "zoom " << zoom;
    EXPECT_LT(cracks, static_cast<std::size_t>(zoom == 1 ? 2 * (kWidth + kHeight) : 1)) << "zoom " << zoom;
  }
}

TEST_F(Shading, AShadowTakesLightAndGivesNone) {
  look_.lamp = true;
  look_.radiance = 0;
  look_.light = {-0.95F, 0, 0.3F};
  const auto drawn = [&](bool shadows) {
    look_.shadows = shadows;
    view_->draw_whole(camera_, look_, kWidth, kHeight);
    return view_->read().bytes;
  };
  const auto without = drawn(false);
  const auto with = drawn(true);
  std::size_t darker = 0;
  std::size_t brighter = 0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    darker += with[i] + 20 < without[i] ? 1 : 0;
    brighter += with[i] > without[i] ? 1 : 0;
  }
  EXPECT_GT(darker, with.size() / 200);
  EXPECT_EQ(brighter, 0U);
}

/// What a wedge is deep, on a tablet of 110 mm.
TEST_F(Shading, AStepOfAThirdOfAMillimetreCastsItsShadow) {
  constexpr float kStepMm = 0.3F;
  Mesh step;
  for (const auto& [x, z] : {std::pair{-55.0F, kStepMm}, {0.0F, kStepMm}, {0.0F, 0.0F}, {55.0F, 0.0F}}) {
    step.positions.emplace_back(x, -40.0F, z);
    step.positions.emplace_back(x, 40.0F, z);
  }
  for (const std::uint32_t k : {0U, 2U, 4U}) {
    step.faces.push_back({k, k + 2, k + 1});
    step.faces.push_back({k + 1, k + 2, k + 3});
  }
  view_->show(shown_mesh(step));
  look_.lamp = true;
  look_.flat = true;
  look_.radiance = 0;
  look_.light = {-0.94F, 0, 0.34F};
  camera_.fit({Eigen::Vector3f(-55, -40, 0), Eigen::Vector3f(55, 40, kStepMm)},
              static_cast<float>(kWidth) / kHeight);
  camera_.half_height_mm = 1.5F;
  const auto brightness_at = [&](float x) {
    const Image picture = view_->read();
    const Eigen::Vector2f at = camera_.pixel_of({x, 0, 0}, {kWidth, kHeight});
    return static_cast<int>(picture.rgb(static_cast<int>(at.x()), static_cast<int>(at.y()))[0]);
  };
  view_->draw_whole(camera_, look_, kWidth, kHeight);
  const float reach_mm = kStepMm * 0.94F / 0.34F;
  const int lit = brightness_at(reach_mm + 0.3F);
  EXPECT_GT(lit, 50);
  EXPECT_EQ(brightness_at(-0.5F), lit);
  for (const float part : {0.3F, 0.5F, 0.7F}) {
    EXPECT_LT(brightness_at(part * reach_mm), lit / 2) << part;
  }
}

/// What looks over the edge of a tile (discs, shadows, shading by depth and curvature) among it.
TEST_F(Shading, APictureDrawnTileByTileHasNoSeamsAndIsThatOfOnePiece) {
  constexpr int kWide = 1300;
  constexpr int kHigh = 1100;
  const ShownMesh shown = shown_mesh(dented_slab(500));
  view_->show(shown);
  ColouredPoints points;
  points.radius_mm = 0.1F;
  for (int k = 0; k < 60; ++k) {
    points.positions_mm.emplace_back(-9 + 0.3F * static_cast<float>(k), 0.02F * static_cast<float>(k), 1.5F);
    points.colours.push_back(k % 2 == 0 ? kAmberOfExcused : Rgb8{255, 0, 0});
  }
  view_->show_points(&points);
  look_.depth_shading = 1.5F;
  camera_.fit(shown.box_mm, static_cast<float>(kWide) / kHigh);
  for (const bool lamp : {false, true}) {
    look_.lamp = lamp;
    look_.light = {-0.9F, 0.3F, 0.35F};
    view_->draw_whole(camera_, look_, kWide, kHigh);
    const Image one = view_->read();
    StillPicture still(camera_, look_, kWide, kHigh);
    int frames = 1;
    while (still.draw_on(*view_)) {
      ++frames;
    }
    EXPECT_GE(frames, 9);  // 3 x 3 tiles
    EXPECT_EQ(view_->read().bytes, one.bytes) << "the picture that is shown stays";
    const Image tiled = still.take();
    ASSERT_EQ(tiled.width, kWide);
    ASSERT_EQ(tiled.height, kHigh);
    if (const char* folder = std::getenv("DUBSAR_KEEP_PICTURES"); folder != nullptr) {
      ASSERT_TRUE(write_picture(fs::path(folder) / (lamp ? "tiled_lamp.png" : "tiled.png"), tiled,
                                {.title = "tiled"}));
    }
    std::size_t other = 0;
    for (int y = 0; y < kHigh; ++y) {
      for (int x = 0; x < kWide; ++x) {
        for (std::size_t k = 0; k < 3; ++k) {
          other +=
              std::abs(int{one.bytes[one.offset(x, y) + k]} - int{tiled.bytes[tiled.offset(x, y) + k]}) > 12;
        }
      }
    }
    // Edges fall otherwise by less than a pixel here and there.
    EXPECT_LT(static_cast<double>(other) / (3.0 * kWide * kHigh), 0.002) << (lamp ? "lamp" : "lit sphere");
  }
}

TEST(PieceSize, LearnsFromWholePiecesAndNotFromWhatIsLeftOver) {
  using std::chrono::milliseconds;
  PieceSize size(100000);
  size.took(5000, milliseconds(1));  // the last of all
  EXPECT_EQ(size.count(), 100000U);
  size.took(100000, milliseconds(5));
  EXPECT_EQ(size.count(), 200000U);
  size.took(200000, milliseconds(30));
  EXPECT_EQ(size.count(), 200000U);
  size.took(150000, milliseconds(80));
  EXPECT_EQ(size.count(), 100000U);
}

TEST_F(Shading, ThePlaceUnderAPixelIsOnTheSurfaceAndTheTapeIsAsLong) {
  view_->draw_whole(camera_, look_, kWidth, kHeight);
  // Where the ray through the pixel's middle meets the clay, from its heights alone.
  const Eigen::Vector3f away = camera_.eye_from_model.conjugate() * -Eigen::Vector3f::UnitZ();
  const auto truth = [&](const Eigen::Vector2f& pixel) {
    const float mm_per_px = camera_.mm_per_px(kHeight);
    const Eigen::Vector3f in_eye((pixel.x() + 0.5F - 0.5F * kWidth) * mm_per_px,
                                 (0.5F * kHeight - pixel.y() - 0.5F) * mm_per_px, 0);
    Eigen::Vector3f at = camera_.centre_mm + camera_.eye_from_model.conjugate() * in_eye - 20 * away;
    while (at.z() > slab_height_mm(at.x(), at.y())) {
      at += 0.001F * away;
    }
    return at;
  };
  const Eigen::Vector2f pixels[] = {{60, 95}, {120, 90}, {150, 40}, {170, 120}};
  std::vector<Eigen::Vector3f> places;
  for (const Eigen::Vector2f& pixel : pixels) {
    for (const float inside : {0.0F, 0.9F}) {  // anywhere in a pixel is that pixel
      const auto place = view_->point_at(pixel.array() + inside);
      ASSERT_TRUE(place);
      EXPECT_LT((*place - truth(pixel)).norm(), 0.01F) << pixel.transpose();
      places.push_back(*place);
    }
  }
  for (std::size_t k = 2; k < places.size(); k += 2) {
    EXPECT_NEAR((places[k] - places[0]).norm(), (truth(pixels[k / 2]) - truth(pixels[0])).norm(), 0.01F);
  }
  EXPECT_FALSE(view_->point_at({1, 1}));
}

}  // namespace
}  // namespace dubsar::ui
