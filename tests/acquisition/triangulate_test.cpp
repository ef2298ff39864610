// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Frames from the simulation through stripe and triangulation, against the surface that was simulated.
#include "acquisition/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/mesh_query.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"
#include "sim/scene.h"

namespace dubsar {
namespace {

/// A wavy patch of clay: z(x, y) over a square, scanner frame.
sim::SimTablet waves(double half_mm) {
  sim::SimTablet tablet;
  constexpr int kSide = 240;
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) {
      const double x = half_mm * (2.0 * i / kSide - 1);
      const double y = half_mm * (2.0 * j / kSide - 1);
      tablet.mesh.positions.emplace_back(x, y, 0.4 * std::sin(1.7 * x) * std::cos(1.3 * y));
      tablet.albedo.push_back(0.5F);
    }
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i;
      tablet.mesh.faces.push_back({a, a + 1, a + kSide + 2});
      tablet.mesh.faces.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  }
  tablet.mesh.normals = vertex_normals(tablet.mesh);
  return tablet;
}

struct Outcome {
  double rms_mm = 0;
  std::size_t samples = 0;
  RangeGrid grid;
};

/// Scans the patch in front of a piece of the usual camera and compares each point with the surface along z.
Outcome scanned(MotionKind motion, double first, double step, int rows, double contrast) {
  sim::FrameRigOptions options;
  options.width = 320;
  options.height = 200;
  options.field_mm = 7.8;
  options.motion = motion;
  const RigCalibration rig = sim::frame_rig(options);
  const sim::SimTablet tablet = waves(7);
  const MeshQuery query(tablet.mesh);
  const sim::Scene scene{&tablet, &query, {}, std::nullopt};
  sim::FrameOptions optics;
  optics.speckle_contrast = contrast;
  const sim::FrameRenderer renderer(rig, optics);
  const Triangulator triangulator(rig, StripeAxis::kPerColumn);
  StripeExtractor extractor{StripeOptions{}};
  StripeProfile stripe;
  FrameGrid grid(triangulator, step);
  for (int row = 0; row < rows; ++row) {
    const double position = first + step * row;
    const sim::SceneTarget target(scene, rig.scanner_from_camera() * rig.motion.zero_from_camera(position));
    const auto number = static_cast<std::uint64_t>(2 * row);
    const GrayImage on = renderer.render(target, true, position, number);
    const GrayImage off = renderer.render(target, false, position, number + 1);
    extractor.extract(on.view(), off.view(), stripe);
    grid.append(stripe, position);
  }
  Outcome out;
  out.grid = grid.take();
  double squares = 0;
  for (std::size_t i = 0; i < out.grid.size(); ++i) {
    if (out.grid.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3f p = out.grid.point(i);
    const auto hit = query.first_hit(p + Eigen::Vector3f(0, 0, 2), -Eigen::Vector3f::UnitZ(), 0, 4);
    if (hit) {
      squares += (hit->distance_mm - 2) * (hit->distance_mm - 2);
      ++out.samples;
    }
  }
  out.rms_mm = std::sqrt(squares / static_cast<double>(out.samples));
  return out;
}

TEST(Triangulate, LinearScanIsTrueToThreeMicrometres) {
  const Outcome out = scanned(MotionKind::kLinear, -0.5, 0.1, 11, 0);
  EXPECT_EQ(out.grid.rows, 11);
  EXPECT_EQ(out.grid.cols, 320);
  EXPECT_GT(out.samples, 3300U);
  EXPECT_LT(out.rms_mm, 0.003);
  EXPECT_NEAR(out.grid.spacing_mm, 0.1, 0.02);
  EXPECT_NEAR(out.grid.view.motion_per_row_mm.y(), 0.1, 1e-6);
  // Rows lie where the stage was.
  EXPECT_NEAR(static_cast<double>(out.grid.y[160]), -0.5, 0.003);
}

TEST(Triangulate, GalvanometerScan) {
  const Outcome out = scanned(MotionKind::kGalvanometer, -0.003, 0.001, 7, 0);
  EXPECT_GT(out.samples, 2100U);
  EXPECT_LT(out.rms_mm, 0.003);
}

TEST(Triangulate, TurntableScan) {
  const Outcome out = scanned(MotionKind::kTurntable, -0.03, 0.01, 7, 0);
  EXPECT_GT(out.samples, 2100U);
  EXPECT_LT(out.rms_mm, 0.003);
}

TEST(Triangulate, SpeckleStaysNearItsBound) {
  // 15 um in depth at f/5.6 and full contrast (Dorsch 1994, shared facts), 0.7 of it here.
  const Outcome out = scanned(MotionKind::kLinear, -0.3, 0.1, 7, 0.7);
  EXPECT_LT(out.rms_mm, 1.2 * 0.7 * 0.015);
  EXPECT_GT(out.rms_mm, 0.3 * 0.7 * 0.015);  // it is there
}

TEST(Triangulate, WhatLiesOutsideOfTheVolumeIsLeftOut) {
  const RigCalibration rig = sim::frame_rig();
  const Triangulator triangulator(rig, StripeAxis::kPerColumn);
  StripeProfile stripe;
  stripe.resize(2048);
  std::fill(stripe.state.begin(), stripe.state.end(), StripeState::kGood);
  std::fill(stripe.at_px.begin(), stripe.at_px.end(),
            2.0F);  // the image's edge: farther than the volume goes
  TriangulatedProfile profile;
  triangulator.triangulate(stripe, 0, profile);
  EXPECT_EQ(std::count(profile.valid.begin(), profile.valid.end(), 1), 0);
}

TEST(Triangulate, TabulatedRaysAreTheCamerasOwn) {
  const RigCalibration rig = sim::frame_rig();
  const Triangulator triangulator(rig, StripeAxis::kPerColumn);
  for (int u = 0; u < 2048; u += 97) {
    for (double v = 3.3; v < 1080; v += 71.7) {
      const auto p = triangulator.point_mm(u, v, rig.laser);
      ASSERT_TRUE(p.has_value());
      EXPECT_LT((rig.camera.project(*p) - Eigen::Vector2d(u, v)).norm(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace dubsar
