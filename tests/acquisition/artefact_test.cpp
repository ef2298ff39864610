// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/artefact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "acquisition/sphere_fit.h"
#include "core/random.h"

namespace dubsar {
namespace {

/// Two balls over a plate as a scanner looking down sees them: heights on a grid.
RangeGrid scanned_bar(double noise_mm, double bent, double scale) {
  RangeGrid grid;
  constexpr int kSide = 320;
  constexpr double kStep = 0.2;
  grid.allocate(kSide, kSide);
  Random random(4);
  const Eigen::Vector3d a = scale * Eigen::Vector3d(-15, 3, 5);
  const Eigen::Vector3d b = scale * Eigen::Vector3d(15, -2, 5);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const double x = kStep * (col - kSide / 2);
      const double y = kStep * (row - kSide / 2);
      double z = bent * (x / 32) * (x / 32);
      for (const Eigen::Vector3d& ball : {a, b}) {
        const double inside =
            scale * scale * 36 - (x - ball.x()) * (x - ball.x()) - (y - ball.y()) * (y - ball.y());
        if (inside > 0) {
          z = std::max(z, ball.z() + std::sqrt(inside));
        }
      }
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(z + noise_mm * random.normal());
      grid.valid[i] = 1;
    }
  }
  return grid;
}

Artefact bar() {
  Artefact artefact;
  artefact.name = "bar";
  artefact.balls = {{12, {0, 0, 0}}, {12, {std::hypot(30.0, 5.0), 0, 0}}};
  artefact.has_plane = true;
  artefact.form_limit_mm = 0.05;
  artefact.size_limit_mm = 0.02;
  artefact.spacing_limit_mm = 0.02;
  artefact.flatness_limit_mm = 0.05;
  return artefact;
}

TEST(Artefact, AGoodScannerPasses) {
  const Result<Verification> is = verify_artefact(scanned_bar(0.004, 0, 1), bar());
  ASSERT_TRUE(is.has_value()) << is.error().line();
  EXPECT_TRUE(is->passed()) << is->failed.front();
  ASSERT_EQ(is->balls.size(), 2U);
  ASSERT_EQ(is->spacings.size(), 1U);
  EXPECT_NEAR(is->spacings[0].error_mm, 0, 0.003);
  EXPECT_NEAR(is->balls[0].diameter_mm, 12, 0.003);
  // The range of thousands of normal samples is some seven standard deviations, less three in a thousand.
  EXPECT_NEAR(is->balls[0].form_mm, 0.024, 0.008);
  EXPECT_NEAR(*is->flatness_mm, 0.024, 0.006);
  EXPECT_NEAR(is->worst_mm(), std::max({is->balls[0].form_mm, is->balls[1].form_mm, *is->flatness_mm}),
              1e-12);
}

TEST(Artefact, AWrongScaleFailsOnSpacingAndSize) {
  // Four in a thousand too large: 120 um over the bar, 48 um over a ball.
  const Result<Verification> is = verify_artefact(scanned_bar(0.004, 0, 1.004), bar());
  ASSERT_TRUE(is.has_value());
  ASSERT_EQ(is->spacings.size(), 1U);
  EXPECT_NEAR(is->spacings[0].error_mm, 0.004 * std::hypot(30.0, 5.0), 0.005);
  EXPECT_NEAR(is->balls[0].size_mm, 0.048, 0.005);
  EXPECT_FALSE(is->passed());
}

TEST(Artefact, ABentPlaneFailsOnFlatness) {
  const Result<Verification> is = verify_artefact(scanned_bar(0.004, 0.3, 1), bar());
  ASSERT_TRUE(is.has_value());
  ASSERT_TRUE(is->flatness_mm.has_value());
  EXPECT_GT(*is->flatness_mm, 0.05);
  EXPECT_FALSE(is->passed());
}

TEST(Artefact, APlaneHasToBeSeenOverItsSize) {
  // 64 mm square, lying askew in the picture.
  RangeGrid grid = scanned_bar(0.004, 0, 1);
  const Eigen::AngleAxisf askew(0.4F, Eigen::Vector3f::UnitZ());
  for (std::size_t i = 0; i < grid.x.size(); ++i) {
    const Eigen::Vector3f p = askew * grid.point(i);
    grid.x[i] = p.x();
    grid.y[i] = p.y();
  }
  Artefact plate = bar();
  plate.plane_mm = {66, 64};
  const Result<Verification> whole = verify_artefact(grid, plate);
  ASSERT_TRUE(whole.has_value());
  EXPECT_TRUE(whole->passed()) << whole->failed.front();
  EXPECT_NEAR(whole->plane_mm[0], 63.8, 0.4);
  EXPECT_NEAR(whole->plane_mm[1], 63.8, 0.4);
  plate.plane_mm = {80, 60};
  const Result<Verification> part = verify_artefact(grid, plate);
  ASSERT_TRUE(part.has_value());
  ASSERT_EQ(part->failed.size(), 1U);
  EXPECT_NE(part->failed[0].find("mm only, and it has 80 x 60 mm"), std::string::npos) << part->failed[0];
}

/// Moves the samples for which `where` holds (x, y in mm) up by so much.
template <typename Where>
RangeGrid moved(RangeGrid grid, float up_mm, Where where) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.z[i] += where(grid.x[i], grid.y[i]) ? up_mm : 0;
  }
  return grid;
}

TEST(Artefact, APartOfThePlaneThatIsFarOffFails) {
  const RangeGrid good = scanned_bar(0.004, 0, 1);
  const auto middle = [](float x, float y) { return std::abs(x) < 16 && y > -24 && y < -8; };
  const auto side = [](float x, float y) { return x > 24 && y < 100; };
  // A dent of half a millimetre, one of more than the outline is made of, and a step that reaches the edge.
  for (const RangeGrid& grid :
       {moved(good, -0.5F, middle), moved(good, 3.0F, middle), moved(good, 0.3F, side)}) {
    const Result<Verification> is = verify_artefact(grid, bar());
    ASSERT_TRUE(is.has_value());
    ASSERT_EQ(is->failed.size(), 1U) << (is->failed.empty() ? "passed" : is->failed.back());
    EXPECT_EQ(is->failed[0].find("off the plane: "), 0U) << is->failed[0];
    EXPECT_GT(is->plane_left_out.count, 5000U);
    EXPECT_EQ(is->worst_mm(), is->plane_left_out.farthest_mm);
  }
  const Result<Verification> is = verify_artefact(moved(good, -0.5F, middle), bar());
  // 159 columns and 79 rows of 0.2 mm.
  EXPECT_EQ(is->plane_left_out.count, 159U * 79U);
  EXPECT_NEAR(is->plane_left_out.farthest_mm, 0.5, 0.03);
  EXPECT_NE(is->failed[0].find("12561 samples within its outline, of "), std::string::npos) << is->failed[0];
}

TEST(Artefact, AFewSamplesOffThePlaneAreLeftOut) {
  const auto speck = [](float x, float y) { return std::abs(x) < 1 && y > -15 && y < -13; };
  const Result<Verification> is = verify_artefact(moved(scanned_bar(0.004, 0, 1), 0.5F, speck), bar());
  ASSERT_TRUE(is.has_value());
  EXPECT_TRUE(is->passed()) << is->failed.front();
  EXPECT_GT(is->plane_left_out.count, 70U);
  EXPECT_NEAR(*is->flatness_mm, 0.024, 0.006);
}

TEST(Artefact, WhatStandsOnThePlaneOrAroundItIsNotThePlane) {
  // The bar between the balls, and the table that the plate lies on.
  const auto rod = [](float x, float y) { return std::abs(x) < 9 && std::abs(y) < 2.5; };
  const auto table = [](float x, float y) { return std::abs(x) > 28 || std::abs(y) > 22; };
  const RangeGrid good = scanned_bar(0.004, 0, 1);
  const Result<Verification> is = verify_artefact(moved(moved(good, 6.0F, rod), -10.0F, table), bar());
  ASSERT_TRUE(is.has_value());
  EXPECT_TRUE(is->passed()) << is->failed.front();
  EXPECT_EQ(is->plane_left_out.count, 0U);
}

/// The first ball of the bar alone.
Artefact ball() {
  Artefact artefact = bar();
  artefact.balls.resize(1);
  artefact.has_plane = false;
  return artefact;
}

/// Without the other ball, and without what is seen more than `cap_deg` from the first one's pole.
RangeGrid scanned_ball(double cap_deg) {
  RangeGrid grid = scanned_bar(0.004, 0, 1);
  const double reach = 6 * std::sin(cap_deg * EIGEN_PI / 180);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = std::hypot(grid.x[i] + 15, grid.y[i] - 3) < reach ? 1 : 0;
  }
  return grid;
}

TEST(Artefact, OfABallMostOfItsFaceHasToBeSeen) {
  const Result<Verification> whole = verify_artefact(scanned_ball(75), ball());
  ASSERT_TRUE(whole.has_value());
  EXPECT_TRUE(whole->passed()) << whole->failed.front();
  EXPECT_EQ(whole->balls[0].parts_seen, 24U);
  const Result<Verification> cap = verify_artefact(scanned_ball(20), ball());
  ASSERT_TRUE(cap.has_value());
  ASSERT_FALSE(cap->failed.empty());
  EXPECT_EQ(cap->failed[0], "seen of ball 1: 8 parts of its face, of 24, and at least 18 have to be");
  // One side in the dark, as behind what stands beside it: a strip of an eighth of the face passes, a half
  // not.
  for (const auto& [beyond_mm, passes] : {std::pair(4.0F, true), std::pair(0.0F, false)}) {
    RangeGrid side = scanned_ball(75);
    for (std::size_t i = 0; i < side.size(); ++i) {
      side.valid[i] = side.x[i] + 15 > beyond_mm ? 0 : side.valid[i];
    }
    const Result<Verification> is = verify_artefact(side, ball());
    ASSERT_TRUE(is.has_value());
    EXPECT_EQ(is->passed(), passes) << beyond_mm;
  }
}

TEST(Artefact, ALumpOnABallFails) {
  // 0.4 mm over a quarter: more than three in a hundred of the radius.
  const auto quarter = [](float x, float y) { return x > -14.5 && y > 3.5; };
  const Result<Verification> is = verify_artefact(moved(scanned_ball(75), 0.4F, quarter), ball());
  ASSERT_TRUE(is.has_value());
  ASSERT_FALSE(is->passed());
  EXPECT_EQ(is->failed[0].find("off ball 1: "), 0U) << is->failed[0];
  EXPECT_GT(is->balls[0].left_out.farthest_mm, 0.2);
  EXPECT_GE(is->worst_mm(), is->balls[0].left_out.farthest_mm);
}

TEST(Artefact, WhatIsNotThereIsSaid) {
  Artefact three = bar();
  three.balls.push_back({25, {100, 0, 0}});
  const Result<Verification> is = verify_artefact(scanned_bar(0.004, 0, 1), three);
  ASSERT_TRUE(is.has_value());
  ASSERT_FALSE(is->failed.empty());
  EXPECT_NE(is->failed[0].find("found: 2, and the artefact has 3"), std::string::npos);
  RangeGrid empty;
  empty.allocate(4, 4);
  EXPECT_FALSE(verify_artefact(empty, bar()).has_value());
}

TEST(Artefact, OneThatIsStoppedGivesNoVerdict) {
  JobContext job;
  job.cancel();
  Artefact plate = bar();
  plate.balls.clear();
  for (const Artefact& artefact : {bar(), plate}) {
    const Result<Verification> is = verify_artefact(scanned_bar(0.004, 0, 1), artefact, job);
    ASSERT_FALSE(is.has_value());
    EXPECT_EQ(is.error().kind, ErrorKind::kCancelled);
  }
}

TEST(SphereFit, ThroughFourPointsAndThroughMany) {
  const Eigen::Vector3d middle(3, -2, 7);
  std::vector<Eigen::Vector3d> points;
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d direction{random.normal(), random.normal(), std::abs(random.normal()) + 0.5};
    points.push_back(middle + 5 * direction.normalized());
  }
  const auto first = sphere_through(points[0], points[1], points[2], points[3]);
  ASSERT_TRUE(first.has_value());
  EXPECT_NEAR(first->radius_mm, 5, 1e-6);
  const auto all = fit_sphere(points, {middle + Eigen::Vector3d(0.3, 0.3, -0.3), 4.5});
  ASSERT_TRUE(all.has_value());
  EXPECT_LT((all->center_mm - middle).norm(), 1e-9);
  EXPECT_FALSE(sphere_through({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}).has_value());
}

}  // namespace
}  // namespace dubsar
