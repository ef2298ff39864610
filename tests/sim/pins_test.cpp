// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/pins.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/units.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

const TestScene& clay() {
  static const TestScene scene([] {
    TabletOptions options = small_clean_tablet();
    options.spacing_mm = 0.3;
    return make_or_fail(options);
  }());
  return scene;
}

/// Distance of p from the pin's body, negative inside, by its definition.
double pin_distance(const Pin& pin, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from_tip = p - pin.tip_mm;
  const double ball = from_tip.norm() - pin.tip_radius_mm;
  const double height = from_tip.dot(pin.arm);
  if (height < 0 || height > pin.arm_length_mm) {
    return ball;
  }
  const double radius =
      pin.tip_radius_mm + (pin.arm_radius_mm - pin.tip_radius_mm) * height / pin.arm_length_mm;
  return std::min(ball, (from_tip - height * pin.arm).norm() - radius);
}

TEST(Pins, RaysMeetThemWhereTheirShapeSays) {
  Pin pin;
  pin.tip_mm = {1, 2, 3};
  pin.arm = Eigen::Vector3d(0.4, -0.3, 0.7).normalized();
  Random random(5);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d aim = pin.tip_mm + random.uniform(-1, 32) * pin.arm + random.normal3();
    const Eigen::Vector3d side = random.normal3().cross(pin.arm).normalized();
    const Eigen::Vector3d origin = aim + 60.0 * side;
    const auto hit = hit_pin(pin, origin, -side, 0, 200);
    // March along the ray: the first step inside must agree.
    double first = -1;
    for (double t = 50; t < 75; t += 0.01) {
      if (pin_distance(pin, origin - t * side) < 0) {
        first = t;
        break;
      }
    }
    if (first >= 0 && hit) {
      EXPECT_NEAR(hit->distance_mm, first, 0.02);
      EXPECT_LT(hit->normal.dot(-side), 1e-9);
      ++hits;
    } else if (hit) {
      EXPECT_GT(pin_distance(pin, origin - hit->distance_mm * side), -1e-6);
    } else {
      EXPECT_LT(first, 0);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(Pins, FifteenStandCloseToTheRimWithoutTouchingIt) {
  const PinStand stand(clay().tablet, clay().query, {});
  const std::vector<Pin> pins = stand.placed(0);
  ASSERT_EQ(pins.size(), 15U);
  for (const Pin& pin : pins) {
    const auto near = clay().query.closest(pin.tip_mm.cast<float>(), 20.0F);
    ASSERT_TRUE(near);
    EXPECT_GE(near->distance_mm - pin.tip_radius_mm, 0.9) << pin.label;
    EXPECT_LE(near->distance_mm - pin.tip_radius_mm, 2.1) << pin.label;
    EXPECT_FALSE(
        clay().query.occluded(pin.tip_mm.cast<float>(), (pin.tip_mm + 30 * pin.arm).cast<float>(), 0));
  }
}

TEST(Pins, ArePutBackWithTheSigmaThatWasAskedFor) {
  const PinStand stand(clay().tablet, clay().query, {});
  const std::vector<Pin> first = stand.placed(0);
  double sum = 0;
  double count = 0;
  for (int placement = 1; placement <= 60; ++placement) {
    const std::vector<Pin> again = stand.placed(placement);
    for (std::size_t k = 0; k < first.size(); ++k) {
      EXPECT_EQ(again[k].label, first[k].label);
      sum += (again[k].tip_mm - first[k].tip_mm).squaredNorm();
      count += 3;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count), 0.3, 0.02);
}

TEST(Pins, ThoseThatHideClayAreTakenAway) {
  ScannerOptions options;
  options.spacing_mm = 0.3;
  options.noise_mm = 0;
  options.dropout = 0;
  options.outlier = 0;
  options.mixed_pixel = 0;
  const TriangulationScanner scanner(options);
  const PinStand stand(clay().tablet, clay().query, {});
  std::vector<Pin> pins = stand.placed(0);
  Pin above = pins.front();
  above.label = 99;
  above.tip_mm = {0, 0, 9};
  above.arm = Eigen::Vector3d(1, 0, 0.5).normalized();
  pins.push_back(above);
  JobContext job;
  for (const double tilt : {0.0, 40.0, 65.0}) {
    const RigidTransform pose{
        Eigen::AngleAxisd(rad_from_deg(tilt), Eigen::Vector3d::UnitX()).toRotationMatrix(), {0, 0, 0}};
    Scene with = clay().scene;
    with.pins = standing_pins(pins, with, scanner, pose);
    EXPECT_TRUE(std::ranges::none_of(with.pins, [](const Pin& pin) { return pin.label == 99; }));
    EXPECT_GE(with.pins.size(), 6U);
    // What stays hides next to nothing: the same cells see the same clay.
    const Result<RangeGrid> bare = scanner.scan_grid(clay().scene, pose, 0, job);
    const Result<RangeGrid> pinned = scanner.scan_grid(with, pose, 0, job);
    ASSERT_TRUE(bare && pinned);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < bare->size(); ++i) {
      if (bare->valid[i] == 0) {
        continue;
      }
      const Eigen::Vector3f p = bare->point(i);
      bool found = false;
      const int row = static_cast<int>(
          std::lround((p.y() - static_cast<float>(pinned->view.laser_mm->y())) / options.spacing_mm));
      for (int c = 0; c < pinned->cols && !found; ++c) {
        found = pinned->is_valid(row, c) && (pinned->point(pinned->index(row, c)) - p).norm() < 0.02F;
      }
      lost += found ? 0 : 1;
    }
    EXPECT_LT(static_cast<double>(lost), 0.005 * static_cast<double>(bare->valid_count())) << tilt;
  }
}

TEST(Pins, TipsAreSeenWhereTheTruthSays) {
  ScannerOptions options;
  options.spacing_mm = 0.1;
  const TriangulationScanner scanner(options);
  Scene scene = clay().scene;
  const PinStand stand(clay().tablet, clay().query, {});
  const RigidTransform pose{Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).toRotationMatrix(), {1, 2, 3}};
  scene.pins = standing_pins(stand.placed(1), scene, scanner, pose);
  JobContext job;
  const Result<RangeGrid> grid = scanner.scan_grid(scene, pose, 0, job);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->pin_tip_diameter_mm, 1.0);
  for (const PinTip& tip : tips_in_scanner(scene.pins, pose)) {
    int on_ball = 0;
    for (std::size_t i = 0; i < grid->size(); ++i) {
      on_ball += grid->valid[i] != 0 &&
                         std::abs((grid->point(i).cast<double>() - tip.position_mm).norm() - 0.5) < 0.08
                     ? 1
                     : 0;
    }
    EXPECT_GT(on_ball, 15) << tip.label;
  }
}

TEST(Pins, ClicksAreGoodToAMillimetre) {
  std::vector<PinTip> truth;
  for (int i = 0; i < 500; ++i) {
    truth.push_back({i, Eigen::Vector3d(i, 0, 0)});
  }
  const std::vector<PinTip> clicked = clicked_tips(truth, 1.0, 7);
  double farthest = 0;
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(clicked[i].label, truth[i].label);
    const double off = (clicked[i].position_mm - truth[i].position_mm).norm();
    farthest = std::max(farthest, off);
    sum += off;
  }
  EXPECT_LE(farthest, 1.0 + 1e-9);
  EXPECT_GT(sum / 500, 0.3);
}

}  // namespace
}  // namespace dubsar::sim
