// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/frame_renderer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

#include "sim/frame_rig.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

/// A piece of the usual camera: the same pixels, fewer of them.
RigCalibration small_rig() {
  FrameRigOptions options;
  options.width = 256;
  options.height = 160;
  options.field_mm = 6.25;
  return frame_rig(options);
}

FrameOptions quiet() {
  FrameOptions options;
  options.read_noise_electrons = 0;
  options.full_well_electrons = 1e9;
  return options;
}

double sum_of(const GrayImage& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
}

class Frames : public testing::Test {
 protected:
  TestScene flat{plane(20, 0.5F, 0.5F)};
  RigCalibration rig = small_rig();
  SceneTarget target{flat.scene, rig.scanner_from_camera()};
};

TEST_F(Frames, StripeFallsWhereTheLaserPlaneMeetsTheSurface) {
  const FrameRenderer renderer(rig, quiet());
  const GrayImage image = renderer.render(target, true, 0, 1);
  const std::vector<double> rows = renderer.true_rows(target, 0);
  const RigidTransform camera_from_scanner = rig.scanner_from_camera().inverse();
  for (int u = 8; u < rig.camera.width - 8; u += 16) {
    // The surface lies 0.5 mm above the middle of the volume.
    const double truth = rows[static_cast<std::size_t>(u)];
    const Eigen::Vector3d x_mm(camera_from_scanner.rotation.transpose().col(0).x() * 0, 0, 0.5);
    EXPECT_NEAR(truth, rig.camera.project(camera_from_scanner * x_mm).y(), 0.5);
    double mass = 0;
    double moment = 0;
    for (int v = static_cast<int>(truth) - 8; v <= static_cast<int>(truth) + 8; ++v) {
      const double light = std::max(0, image.at(u, v) - 8);
      mass += light;
      moment += light * v;
    }
    ASSERT_GT(mass, 100);
    EXPECT_NEAR(moment / mass, truth, 0.03);
  }
}

TEST_F(Frames, LaserOffLeavesTheAmbientLightAlone) {
  FrameOptions options = quiet();
  options.ambient_signal = 0.1;
  const FrameRenderer renderer(rig, options);
  const GrayImage image = renderer.render(target, false, 0, 1);
  EXPECT_NEAR(sum_of(image) / static_cast<double>(image.pixels.size()), 1 + 25.5 * 0.92, 4);
  options.ambient_signal = 0;
  EXPECT_DOUBLE_EQ(sum_of(FrameRenderer(rig, options).render(target, false, 0, 1)),
                   static_cast<double>(image.pixels.size()));  // the black level
}

TEST_F(Frames, SpeckleHasTheContrastThatWasAskedForAndKeepsTheLight) {
  FrameOptions options = quiet();
  options.ambient_signal = 0;
  options.laser_sigma_mm = 0.25;  // a broad stripe, in whose middle the light is even
  options.laser_signal = 0.15;
  const double calm = sum_of(FrameRenderer(rig, options).render(target, true, 0, 1));
  const auto contrast_of = [&](double contrast, double f_number) {
    options.speckle_contrast = contrast;
    options.f_number = f_number;
    const FrameRenderer renderer(rig, options);
    const GrayImage image = renderer.render(target, true, 0, 1);
    EXPECT_NEAR(sum_of(image) / calm, 1, 0.05);
    const int row = static_cast<int>(renderer.true_rows(target, 0)[128]);
    double sum = 0;
    double squares = 0;
    int count = 0;
    for (int v = row - 3; v <= row + 3; ++v) {
      for (int u = 10; u < 246; ++u) {
        const double light = image.at(u, v) - 1;
        sum += light;
        squares += light * light;
        ++count;
      }
    }
    const double mean = sum / count;
    return std::sqrt(squares / count - mean * mean) / mean;
  };
  // At f/16 a speckle (13 um) is wider than a pixel (5.5 um), which averages little of it away.
  EXPECT_NEAR(contrast_of(1.0, 16), 0.9, 0.12);
  EXPECT_NEAR(contrast_of(0.5, 16), 0.45, 0.07);
  // At f/2 some twelve speckles share a pixel.
  EXPECT_LT(contrast_of(1.0, 2), 0.5);
  EXPECT_LT(contrast_of(0.0, 5.6), 0.06);
}

TEST_F(Frames, SameBytesForAnyNumberOfThreads) {
  FrameOptions options;
  options.speckle_contrast = 0.7;
  const FrameRenderer renderer(rig, options);
  const GrayImage many = renderer.render(target, true, 0, 5);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many.pixels, renderer.render(target, true, 0, 5).pixels);
  EXPECT_NE(many.pixels, renderer.render(target, true, 0, 6).pixels);
}

TEST(FrameShadows, NothingIsLitBehindAnEdge) {
  // A block beside the stripe's way on the camera's side leaves the floor before it in the laser's light, but
  // hides it from the camera.
  SimTablet tablet = plane(20, -3, 0.5F);
  add_block(&tablet, 1.5F, 0.2F, -3, 1, 0.5F);
  const TestScene made(std::move(tablet));
  const RigCalibration rig = small_rig();
  const SceneTarget target(made.scene, rig.scanner_from_camera());
  const FrameRenderer renderer(rig, quiet());
  const GrayImage image = renderer.render(target, true, 0, 1);
  const std::vector<double> rows = renderer.true_rows(target, 0);
  // On the block's top in the middle, on the floor at the sides, 4 mm of depth apart: 70 px.
  ASSERT_TRUE(std::isfinite(rows[128]) && std::isfinite(rows[20]));
  EXPECT_NEAR(std::abs(rows[128] - rows[20]), 4 / rig.depth_per_px_mm(), 3);
  int lit = 0;
  for (int v = 0; v < image.height; ++v) {
    lit += image.at(128, v) > 60 && std::abs(v - rows[128]) > 8 ? 1 : 0;
  }
  EXPECT_EQ(lit, 0);
}

TEST(FrameGloss, AGlossyWallGivesASecondStripe) {
  SimTablet tablet = plane(20, 0, 0.5F);
  add_quad(&tablet, {-10, 1, 0}, {10, 1, 0}, {10, 1.8F, 2}, {-10, 1.8F, 2}, 0.5F);
  const TestScene made(std::move(tablet));
  const RigCalibration rig = small_rig();
  RigidTransform shift;
  shift.translation_mm.y() = 1.4;
  const SceneTarget target(made.scene, shift * rig.scanner_from_camera());
  FrameOptions options = quiet();
  options.ambient_signal = 0;
  const GrayImage plain = FrameRenderer(rig, options).render(target, true, 0, 1);
  options.gloss = 0.8;
  const GrayImage glossy = FrameRenderer(rig, options).render(target, true, 0, 1);
  EXPECT_GT(sum_of(glossy), 1.02 * sum_of(plain));
}

TEST(FrameOptics, AiryDiscHasItsFirstDarkRing) {
  const PointSpread spread = point_spread(4.0, 0.25, 0);
  // First zero at 1.22 · 4.0 um = 19.5 samples.
  EXPECT_LT(std::norm(spread.at(20, 0)), 1e-3F * std::norm(spread.at(0, 0)));
  EXPECT_GT(std::norm(spread.at(26, 0)), 5e-3F * std::norm(spread.at(0, 0)));
  double energy = 0;
  for (const auto& h : spread.amplitude) {
    energy += static_cast<double>(std::norm(h));
  }
  EXPECT_NEAR(energy, 1, 1e-4);
  EXPECT_GT(point_spread(4.0, 0.25, 1.0).sigma(), 1.5 * spread.sigma());
}

}  // namespace
}  // namespace dubsar::sim
