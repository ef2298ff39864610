// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/pin_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dubsar {
namespace {

constexpr double kCubeMm = 30;
constexpr double kEdgeMm = 1.5;

PinLayoutOptions quick_options() {
  PinLayoutOptions options;
  options.search_rounds = 2;
  options.directions = 1000;
  options.rolls = 12;
  options.proof_views = 20;
  return options;
}

std::vector<PinBody> bodies_of(const TabletHull& hull, const PinLayout& layout, const PinShape& shape) {
  std::vector<PinBody> bodies;
  for (const PlannedPin& pin : layout.pins) {
    bodies.emplace_back(hull, pin.pose, shape);
  }
  return bodies;
}

// Seed 001, 3.2: fifteen pins are sufficient to see at least eight non-occluding ones from any view around a
// cube. A view is one viewpoint there.
TEST(PinLayout, EightOfFifteenFromEveryViewpointAroundACube) {
  PinLayoutOptions options = quick_options();
  options.search_rounds = 10;
  options.triangulation_rad = rad_from_deg(0.05);  // laser and camera at one place
  options.directions = 4000;
  options.rolls = 1;
  options.proof_views = 20000;
  const TabletHull cube = hull_of_box(Eigen::Vector3d::Constant(kCubeMm), kEdgeMm);
  const Result<PinLayout> layout = plan_pin_layout(cube, kEdgeMm, options, JobContext{});
  ASSERT_TRUE(layout.has_value()) << layout.error().line();
  ASSERT_EQ(layout->pins.size(), 15U);
  EXPECT_GE(layout->census.least, 8);
  EXPECT_GE(layout->proven, 8);  // by cells: nothing between the enumerated directions can have fewer
  EXPECT_LE(layout->proven, layout->census.least);
  PinLayoutOptions exact = options;
  exact.triangulation_rad = 0;
  EXPECT_TRUE(
      at_least_seen_everywhere(cube, bodies_of(cube, *layout, options.shape), 8, exact, JobContext{}));

  // What is claimed is broken by taking pins away: the proof can fail.
  std::vector<PinBody> bodies = bodies_of(cube, *layout, options.shape);
  bodies.erase(bodies.begin() + 9, bodies.end());
  EXPECT_LT(count_pins_seen(cube, bodies, options).least, 8);
  EXPECT_FALSE(at_least_seen_everywhere(cube, bodies, 8, options, JobContext{}));
}

TEST(PinLayout, KeepsPinsApartAndOffTheClay) {
  const PinLayoutOptions options = quick_options();
  const TabletHull cube = hull_of_box(Eigen::Vector3d::Constant(kCubeMm), kEdgeMm);
  const Result<PinLayout> layout = plan_pin_layout(cube, kEdgeMm, options, JobContext{});
  ASSERT_TRUE(layout.has_value());
  // With laser and camera apart both must see a pin: fewer than from one viewpoint.
  EXPECT_GE(layout->census.least, 5);
  for (std::size_t i = 0; i < layout->pins.size(); ++i) {
    const PlannedPin& pin = layout->pins[i];
    EXPECT_EQ(pin.number, static_cast<int>(i) + 1);
    EXPECT_NEAR(pin.pose.arm.norm(), 1.0, 1e-9);
    EXPECT_NEAR(cube.clearance_mm(pin.rim_mm), 0.0, 1e-9);
    const double gap = cube.clearance_mm(pin.pose.tip_mm) - options.shape.tip_radius_mm;
    EXPECT_GE(gap, options.shape.gap_mm - 1e-9);
    EXPECT_LE(gap, options.shape.most_gap_mm + 1e-9);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((pin.pose.tip_mm - layout->pins[j].pose.tip_mm).norm(), options.tip_spacing_mm);
    }
  }
  const Result<PinLayout> again = plan_pin_layout(cube, kEdgeMm, options, JobContext{});
  ASSERT_TRUE(again.has_value());
  for (std::size_t i = 0; i < layout->pins.size(); ++i) {
    EXPECT_EQ(again->pins[i].pose.tip_mm, layout->pins[i].pose.tip_mm);
  }
}

TEST(PinLayout, RefusesWhatHasNoSize) {
  const TabletHull nothing;
  EXPECT_FALSE(plan_pin_layout(nothing, 1, PinLayoutOptions{}, JobContext{}).has_value());
  PinLayoutOptions many;
  many.count = 16;
  EXPECT_FALSE(plan_pin_layout(hull_of_box({30, 30, 30}, 1), 1, many, JobContext{}).has_value());
}

/// One pin on the right edge of a flat tablet, level.
class PinSight : public ::testing::Test {
 protected:
  TabletHull hull = hull_of_box({60, 40, 15}, 1.5);
  PinBody pin{hull, {{32, 0, 0}, {1, 0, 0}}, PinShape{}};

  [[nodiscard]] bool seen(const Eigen::Vector3d& laser, const Eigen::Vector3d& camera) const {
    return stands_and_shows(pin, Sightline(hull, laser.normalized(), 0),
                            Sightline(hull, camera.normalized(), 0));
  }
};

TEST_F(PinSight, ShowsBesideTheObverse) {
  EXPECT_TRUE(seen({0, 0, 1}, {0, 0.4, 1}));
}
TEST_F(PinSight, HidesTheEdgeThatItStandsBefore) {
  EXPECT_FALSE(seen({1, 0, 0}, {1, 0.4, 0}));
  EXPECT_TRUE(pin.shades(Sightline(hull, {1, 0, 0}, 0), Sightline(hull, {1, 0, 0}, 0)));
}
TEST_F(PinSight, IsHiddenBehindTheTablet) {
  EXPECT_FALSE(pin.tip_is_free(Sightline(hull, {-1, 0, 0}, 0)));
  EXPECT_TRUE(pin.tip_is_never_free(Sightline(hull, {-1, 0, 0}, 0.01)));
}
TEST_F(PinSight, MayShadeWhatTheCameraNeverSees) {
  // The laser's shadow of the pin falls on the right edge; the camera looks from the left.
  EXPECT_TRUE(seen({0.15, 0, 1}, {-0.15, 0, 1}));
}
TEST_F(PinSight, AnotherArmHidesATip) {
  const PinBody before{hull, {{32, 0, 12}, {1, 0, 0}}, PinShape{}};
  EXPECT_TRUE(pin.tip_is_behind(before, Sightline(hull, {0, 0, 1}, 0)));
  EXPECT_FALSE(before.tip_is_behind(pin, Sightline(hull, {0, 0, 1}, 0)));
  EXPECT_FALSE(pin.tip_is_behind(before, Sightline(hull, Eigen::Vector3d(0, 0.4, 1).normalized(), 0)));
}

// The margins' promise, on which the proof stands: what holds with a margin holds for directions within it.
TEST_F(PinSight, MarginsHoldForTheDirectionsWithin) {
  constexpr double kMargin = 0.05;
  constexpr double kApart = rad_from_deg(24.0);
  int held = 0;
  int failed = 0;
  for (int i = 0; i < 4000; ++i) {
    const double z = -1 + 2 * (i + 0.5) / 4000;
    const double turn = 2.399963 * i;
    const double level = std::sqrt(1 - z * z);
    const SightView view = sight_view({level * std::cos(turn), level * std::sin(turn), z}, 0.7 * i, kApart);
    const Sightline laser(hull, view.to_laser, kMargin);
    const Sightline camera(hull, view.to_camera, kMargin);
    const bool holds = stands_and_shows(pin, laser, camera);
    const bool fails = never_stands_and_shows(pin, laser, camera);
    EXPECT_FALSE(holds && fails);
    for (int k = 0; k < 6; ++k) {
      const auto beside = [&](const Eigen::Vector3d& d, int axis) {
        Eigen::Vector3d moved = d;
        moved[axis] += k % 2 == 0 ? 0.9 * kMargin : -0.9 * kMargin;
        moved.normalize();
        return (moved - d).norm() <= kMargin ? moved : d;
      };
      const bool there = seen(beside(view.to_laser, k / 2), beside(view.to_camera, (k + 1) % 3));
      EXPECT_TRUE(!holds || there);
      EXPECT_TRUE(!fails || !there);
    }
    held += holds ? 1 : 0;
    failed += fails ? 1 : 0;
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(failed, 400);
}

}  // namespace
}  // namespace dubsar
