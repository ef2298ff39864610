// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/screen_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

constexpr double kMmPerPx = 0.05;

SurfacePixels pixels_of(const Mesh& mesh, double size_mm) {
  const RenderScene scene(mesh);
  const ViewCamera camera = face_camera(Face::kObverse);
  const int px = static_cast<int>(size_mm / kMmPerPx);
  const Framing framing{px, px, -size_mm / 2, size_mm / 2, 0.0, kMmPerPx};
  return resolve(rasterise(scene, camera, framing, 1), scene, camera, RenderStyle::kClay, 1);
}

std::size_t at(const SurfacePixels& pixels, double x, double y) {
  const auto col = static_cast<std::size_t>(x / kMmPerPx + pixels.width / 2.0);
  const auto row = static_cast<std::size_t>(pixels.height / 2.0 - y / kMmPerPx);
  return row * static_cast<std::size_t>(pixels.width) + col;
}

TEST(SkyVisibility, IsWholeOnAPlaneHoweverTilted) {
  const SurfacePixels pixels =
      pixels_of(height_sheet(64, 10.0F, [](float x, float y) { return 0.4F * x - 0.7F * y; }), 8.0);
  for (const float open : sky_visibility(pixels, kMmPerPx, 1.0)) {
    EXPECT_NEAR(open, 1.0F, 2e-2F);
  }
}

TEST(SkyVisibility, DeeperRecessesReceiveLessLight) {
  const auto floor_of = [](float depth) {
    const SurfacePixels pixels = pixels_of(
        height_sheet(320, 8.0F, [&](float x, float) { return std::abs(x) < 0.4F ? -depth : 0.0F; }), 7.8);
    return sky_visibility(pixels, kMmPerPx, 2.0)[at(pixels, 0, 0)];
  };
  EXPECT_LT(floor_of(0.2F), 0.95F);
  EXPECT_LT(floor_of(0.6F), floor_of(0.2F) - 0.1F);
}

TEST(LampVisibility, AWallThrowsItsShadowAwayFromTheLamp) {
  const SurfacePixels pixels = pixels_of(
      height_sheet(320, 8.0F, [](float x, float) { return std::abs(x) < 0.2F ? 1.0F : 0.0F; }), 7.8);
  const auto open = lamp_visibility(pixels, kMmPerPx, 3.0, Eigen::Vector3d(-1, 0, 1).normalized());
  EXPECT_LT(open[at(pixels, 0.6, 0)], 0.2F);
  EXPECT_GT(open[at(pixels, -0.6, 0)], 0.99F);
  EXPECT_GT(open[at(pixels, 2.5, 0)], 0.99F) << "a wall of 1 mm under a lamp at 45 degrees shades 1 mm";
}

/// A floor that sinks away under a ledge, from nothing to 12 mm: no two pixels beside each other differ by
/// more than the slope explains, also where the ledge stands so far in front that it no longer counts.
TEST(ScreenLight, ComesBackGraduallyWhereTheSurroundingsAreTooFarInFront) {
  const auto place = [](float x, float y) { return x > 0 ? 0.0F : -0.6F * (y + 10.0F); };
  const SurfacePixels pixels = pixels_of(height_sheet(640, 20.0F, place), 19.0);
  const auto sky = sky_visibility(pixels, kMmPerPx, 1.0);
  const auto lamp = lamp_visibility(pixels, kMmPerPx, 1.0, Eigen::Vector3d(1, 0, 1).normalized());
  float sky_step = 0;
  float lamp_step = 0;
  for (double y = -9.0; y < 9.0; y += kMmPerPx) {
    const std::size_t i = at(pixels, -0.3, y), next = at(pixels, -0.3, y + kMmPerPx);
    sky_step = std::max(sky_step, std::abs(sky[next] - sky[i]));
    lamp_step = std::max(lamp_step, std::abs(lamp[next] - lamp[i]));
  }
  EXPECT_LT(sky_step, 0.025F);
  EXPECT_LT(lamp_step, 0.045F);
}

TEST(Bending, IsPositiveOnRidgesNegativeInValleysAndNoughtBetween) {
  const SurfacePixels pixels =
      pixels_of(height_sheet(320, 8.0F, [](float x, float) { return 0.3F * std::cos(2.0F * x); }), 7.8);
  const auto bend = bending(pixels, kMmPerPx, 0.6);
  EXPECT_GT(bend[at(pixels, 0, 0)], 0.3F);
  EXPECT_LT(bend[at(pixels, 1.5708, 0)], -0.3F);
  EXPECT_NEAR(bend[at(pixels, 0.7854, 0)], 0.0F, 0.1F);
}

}  // namespace
}  // namespace dubsar
