// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/swept_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "acquisition/row_window.h"
#include "sim/frame_rig.h"

namespace dubsar {
namespace {

constexpr double kSheetSigma_mm = 0.02;

/// A tilted plane of clay with bands of dark and bright, which pull at the stripe of a single picture.
struct BandedClay {
  RigCalibration rig;
  Plane surface;                 // camera frame at position 0
  double bands_per_radian = 20;  // per mm across them, that is

  explicit BandedClay(MotionKind motion) {
    sim::FrameRigOptions options;
    options.width = 96;
    options.height = 120;
    options.field_mm = 96 * 50.0 / 2048;
    options.motion = motion;
    rig = sim::frame_rig(options);
    surface.normal = Eigen::Vector3d(0.1, 0.2, -1).normalized();
    surface.distance_mm = surface.normal.dot(Eigen::Vector3d(0, 0, options.distance_mm));
  }
  [[nodiscard]] double albedo(const Eigen::Vector3d& p) const {
    return 0.55 + 0.4 * std::sin(bands_per_radian * p.y());
  }
  /// What the camera sees at `position`: no noise, no blur.
  [[nodiscard]] GrayImage picture(double position) const {
    const RigidTransform zero_from_camera = rig.motion.zero_from_camera(position);
    const Plane here = transformed(zero_from_camera.inverse(), surface);
    const Plane laser = rig.motion.laser_at(rig.laser, position);
    GrayImage out(rig.camera.width, rig.camera.height);
    for (int v = 0; v < out.height; ++v) {
      for (int u = 0; u < out.width; ++u) {
        const Eigen::Vector2d n = rig.camera.undistort(Eigen::Vector2d(u, v)).value();
        const Eigen::Vector3d ray(n.x(), n.y(), 1);
        const Eigen::Vector3d p = here.along(Eigen::Vector3d::Zero(), ray).value() * ray;
        const double off = laser.signed_distance_mm(p) / kSheetSigma_mm;
        out.pixels[out.index(u, v)] = static_cast<std::uint8_t>(
            std::lround(240 * albedo(zero_from_camera * p) * std::exp(-0.5 * off * off)));
      }
    }
    return out;
  }
  [[nodiscard]] SweptRow row(std::int64_t number, double position) const {
    StripeOptions options;
    options.keep_light = true;
    SweptRow out{number, 1000 * number, position, {}};
    StripeExtractor(options).extract(picture(position).view(), {}, out.stripe);
    return out;
  }
  /// Of the points of a row from the clay, mm.
  [[nodiscard]] double rms_mm(const TriangulatedProfile& points) const {
    const RigidTransform zero_from_scanner = rig.scanner_from_camera().inverse();
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < points.valid.size(); ++i) {
      if (points.valid[i] != 0) {
        const Eigen::Vector3d p(static_cast<double>(points.x[i]), static_cast<double>(points.y[i]),
                                static_cast<double>(points.z[i]));
        squares += std::pow(surface.signed_distance_mm(zero_from_scanner * p), 2);
        ++count;
      }
    }
    EXPECT_GT(count, 60);
    return std::sqrt(squares / count);
  }
};

std::vector<const SweptRow*> pointers(const std::vector<SweptRow>& rows) {
  std::vector<const SweptRow*> out;
  for (const SweptRow& row : rows) {
    out.push_back(&row);
  }
  return out;
}

struct Case {
  MotionKind motion;
  double step;  // that moves the sheet by 25 µm on the clay, or so
};

class SweptLights : public testing::TestWithParam<Case> {};

TEST_P(SweptLights, ShadeNoLongerMovesTheClay) {
  const BandedClay clay(GetParam().motion);
  const Triangulator triangulator(clay.rig, StripeAxis::kPerColumn);
  const SweptLight light(triangulator, 1.2);
  const double step = GetParam().step;
  const int reach = light.reach(step);
  ASSERT_GE(reach, 2);
  std::vector<double> alone;
  std::vector<double> together;
  for (const double middle : {-0.11, 0.0, 0.07}) {  // dark to bright, bright, bright to dark
    std::vector<SweptRow> rows;
    for (int k = -reach; k <= reach; ++k) {
      rows.push_back(clay.row(k, (middle / 0.025 + k + 0.1 * (k % 2)) * step));  // no stage is quite even
    }
    TriangulatedProfile points;
    triangulator.triangulate(rows[static_cast<std::size_t>(reach)].stripe,
                             rows[static_cast<std::size_t>(reach)].position, points);
    alone.push_back(clay.rms_mm(points));
    light.correct(pointers(rows), static_cast<std::size_t>(reach), points);
    together.push_back(clay.rms_mm(points));
    EXPECT_LT(together.back(), 0.002);
  }
  EXPECT_GT(std::max(alone.front(), alone.back()), 0.008);
}

INSTANTIATE_TEST_SUITE_P(Motions, SweptLights,
                         testing::Values(Case{MotionKind::kLinear, 0.025},
                                         Case{MotionKind::kGalvanometer, 0.025 / 250},
                                         Case{MotionKind::kTurntable, 0.025 / 20}));

TEST(SweptLight, RowsFarApartSayNothing) {
  const BandedClay clay(MotionKind::kLinear);
  const Triangulator triangulator(clay.rig, StripeAxis::kPerColumn);
  const SweptLight light(triangulator, 1.2);
  EXPECT_EQ(light.reach(0.06), 0);
  EXPECT_GT(light.reach(0.01), light.reach(0.025));
  // Nor does one whose neighbours were lost.
  const std::vector<SweptRow> rows{clay.row(0, -0.06), clay.row(1, 0), clay.row(2, 0.025)};
  TriangulatedProfile points;
  triangulator.triangulate(rows[1].stripe, 0, points);
  const TriangulatedProfile before = points;
  light.correct(pointers(rows), 1, points);
  EXPECT_EQ(points.z, before.z);
}

TEST(RowWindow, GivesEveryRowOnceAndInOrderEachWithItsNeighbours) {
  const BandedClay clay(MotionKind::kLinear);
  const Triangulator triangulator(clay.rig, StripeAxis::kPerColumn);
  StripeOptions options;
  options.keep_light = true;
  RowWindow window(triangulator, options, 0.025);
  std::vector<std::int64_t> given;
  std::vector<std::vector<float>> depths;
  const RowWindow::Give give = [&](const Profile& profile) -> Status {
    given.push_back(profile.row);
    depths.emplace_back(profile.z.begin(), profile.z.end());
    EXPECT_EQ(profile.timestamp_ns, 1000 * profile.row);
    return {};
  };
  constexpr int kRows = 12;
  std::vector<SweptRow> rows;
  for (int k = 0; k < kRows; ++k) {
    rows.push_back(clay.row(k, 0.025 * k));
    ASSERT_TRUE(window.take(rows.back(), give));
  }
  const int reach = SweptLight(triangulator, options.sigma_px).reach(0.025);
  EXPECT_EQ(given.size(), static_cast<std::size_t>(kRows - reach));
  ASSERT_TRUE(window.finish(give));
  ASSERT_EQ(given.size(), static_cast<std::size_t>(kRows));
  for (int k = 0; k < kRows; ++k) {
    EXPECT_EQ(given[static_cast<std::size_t>(k)], k);
  }
  // Row 6 is as all its neighbours together make it.
  TriangulatedProfile points;
  triangulator.triangulate(rows[6].stripe, rows[6].position, points);
  const auto first = rows.begin() + 6 - reach;
  SweptLight(triangulator, options.sigma_px)
      .correct(pointers({first, first + 2 * reach + 1}), static_cast<std::size_t>(reach), points);
  EXPECT_EQ(depths[6], points.z);
}

TEST(RowWindow, AFixedDetectorWaitsForNobody) {
  const BandedClay clay(MotionKind::kLinear);
  const Triangulator triangulator(clay.rig, StripeAxis::kPerColumn);
  StripeOptions options;
  options.method = StripeMethod::kSteger;
  RowWindow window(triangulator, options, 0.025);
  int given = 0;
  ASSERT_TRUE(window.take(clay.row(0, 0), [&](const Profile& /*profile*/) -> Status {
    ++given;
    return {};
  }));
  EXPECT_EQ(given, 1);
}

TEST(RowWindow, WhoWantsNoMoreGetsNoMore) {
  const BandedClay clay(MotionKind::kLinear);
  const Triangulator triangulator(clay.rig, StripeAxis::kPerColumn);
  RowWindow window(triangulator, StripeOptions{}, 1.0);
  const Status refused = window.take(
      clay.row(0, 0), [](const Profile& /*profile*/) -> Status { return fail(ErrorKind::kCancelled, "no"); });
  EXPECT_FALSE(refused);
}

}  // namespace
}  // namespace dubsar
