// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/surface_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "core/units.h"
#include "planning/cleared_map.h"
#include "planning/red_map.h"
#include "planning/rim_targets.h"
#include "planning/sparse_flags.h"

namespace dubsar {
namespace {

constexpr double kSpacingMm = 0.1;

/// A plane of 12 mm, with samples where `there` says so (x, y in mm, from the middle); shifted by a part of
/// µ.
struct Plate {
  Plate(const std::function<bool(double, double)>& there, double shift_mm, double spacing_mm = kSpacingMm) {
    const int across = static_cast<int>(std::lround(12.0 / spacing_mm));
    const double middle = 0.5 * (across - 1);
    grid.allocate(across, across);
    grid.spacing_mm = spacing_mm;
    for (int r = 0; r < grid.rows; ++r) {
      for (int c = 0; c < grid.cols; ++c) {
        const double x = (c - middle) * spacing_mm + shift_mm;
        const double y = (r - middle) * spacing_mm + shift_mm;
        const std::size_t i = grid.index(r, c);
        grid.x[i] = static_cast<float>(x);
        grid.y[i] = static_cast<float>(y);
        grid.z[i] = 0.0F;
        grid.valid[i] = there(x, y) ? 1 : 0;
      }
    }
    flags = flag_sparse(grid);
  }
  [[nodiscard]] PlacedScan placed(int id) const { return {id, &grid, &flags, {}, 0.0}; }

  RangeGrid grid;
  SampleFlags flags;
};

bool outside_disc(double x, double y, double radius_mm) {
  return std::hypot(x, y) > radius_mm;
}

std::vector<Hole> inner_holes(const SurfaceCover& cover) {
  std::vector<Hole> inner;
  for (const Hole& hole : cover.holes()) {
    if (hole.width_mm < 8.0) {
      inner.push_back(hole);
    }
  }
  return inner;
}

TEST(SurfaceCover, AHoleHasARimAndAnArea) {
  const Plate plate([](double x, double y) { return outside_disc(x, y, 1.0); }, 0);
  const PlacedScan scans[] = {plate.placed(0)};
  const SurfaceCover cover(scans);
  const auto holes = inner_holes(cover);
  ASSERT_EQ(holes.size(), 1U);
  // The rim runs through the good samples around the border that is flagged.
  EXPECT_NEAR(holes[0].width_mm, 2.4, 0.5);
  EXPECT_NEAR(holes[0].area_mm2, 4.5, 1.8);
  for (const std::uint32_t i : holes[0].rim) {
    const Rim& rim = cover.rims()[i];
    EXPECT_GT(rim.normal.z(), 0.99);
    EXPECT_LT(rim.outward.dot(rim.position_mm), 0) << "outward leads into the hole";
  }
  EXPECT_EQ(cover.at({3, 3, 0}, cover.reach_mm()), SurfaceCover::Place::kClosed);
  EXPECT_EQ(cover.at({1.15, 0, 0}, cover.reach_mm()), SurfaceCover::Place::kRim);
  EXPECT_EQ(cover.at({0, 0, 0}, 0.5), SurfaceCover::Place::kBare);
}

/// Or a tablet with a hollow is conclusive though nobody saw its thin floor from below.
TEST(SurfaceCover, TheOtherSideOfThinClayClosesNoHole) {
  const Plate above([](double x, double y) { return outside_disc(x, y, 1.0); }, 0);
  const Plate below([](double, double) { return true; }, 0.03);
  for (const double thick_mm : {0.15, 0.2, 0.3}) {
    PlacedScan turned = below.placed(1);
    turned.model_from_scanner = RigidTransform::from_twist({kPi, 0, 0}, {0, 0, -thick_mm});
    const std::vector scans{above.placed(0), turned};
    const SurfaceCover cover(scans);
    const auto holes = inner_holes(cover);
    ASSERT_EQ(holes.size(), 1U) << thick_mm;
    EXPECT_NEAR(holes[0].width_mm, 2.4, 0.5) << thick_mm;
  }
}

TEST(SurfaceCover, AGapThatTheRuleLetsPassIsNoHole) {
  const Plate plate([](double x, double y) { return outside_disc(x, y, 0.12); }, 0);
  const PlacedScan scans[] = {plate.placed(0)};
  EXPECT_TRUE(inner_holes(SurfaceCover(scans)).empty());
}

TEST(SurfaceCover, AnotherScanClosesTheHole) {
  const Plate one([](double x, double y) { return outside_disc(x, y, 1.0); }, 0);
  const Plate other([](double x, double y) { return outside_disc(x - 3, y, 1.0); }, 0.03);
  const PlacedScan scans[] = {one.placed(0), other.placed(1)};
  EXPECT_TRUE(inner_holes(SurfaceCover(scans)).empty());
}

TEST(SurfaceCover, ARimThatTwoScansClearedForEachOtherIsStillFound) {
  // Both see the hole up to the same edge, their samples half a step apart: each border lies on good samples
  // of the other.
  const auto there = [](double x, double y) { return outside_disc(x, y, 1.0); };
  const Plate one(there, 0);
  const Plate other(there, 0.05);
  ClearingOptions generous;
  generous.spacing_factor = 2.5;
  ClearedMap map(generous);
  map.add(one.placed(0));
  map.add(other.placed(1));
  const auto scans = map.scans();
  int red_at_hole = 0;
  for (const PlacedScan& scan : scans) {
    for (std::size_t i = 0; i < scan.grid->size(); ++i) {
      red_at_hole += is_red((*scan.flags)[i]) && scan.grid->point(i).norm() < 3 ? 1 : 0;
    }
  }
  ASSERT_EQ(red_at_hole, 0) << "the flags alone say that nothing is missing";

  const SurfaceCover cover(scans);
  ASSERT_FALSE(inner_holes(cover).empty());
  RedTargets red;
  add_rim_targets(cover, 5.0, {}, red);
  double area = 0;
  for (const RedTarget& t : red.targets) {
    EXPECT_TRUE(t.rim);
    EXPECT_EQ(t.state, RegionState::kRed);
    area += t.position_mm.head<2>().norm() < 3 ? t.area_mm2 : 0.0;
  }
  EXPECT_NEAR(area, 3.9, 1.5);
}

/// Holes every 2 mm, each a little off, so that the samples meet them all differently.
constexpr double kBetweenHolesMm = 2.0;
constexpr int kHolesAcross = 5;
Eigen::Vector2d middle_of_hole(int row, int col) {
  return {(col - 2) * kBetweenHolesMm + 0.05 * std::sin(3 * col + 7 * row),
          (row - 2) * kBetweenHolesMm + 0.05 * std::cos(5 * col + row)};
}

std::function<bool(double, double)> outside_all_discs(double radius_mm) {
  return [=](double x, double y) {
    for (int k = 0; k < kHolesAcross * kHolesAcross; ++k) {
      if ((Eigen::Vector2d(x, y) - middle_of_hole(k / kHolesAcross, k % kHolesAcross)).norm() <= radius_mm) {
        return false;
      }
    }
    return true;
  };
}

TEST(SurfaceCover, SmallRoundHolesThatAllScansSeeAreFound) {
  for (const double radius_mm : {0.25, 0.3, 0.35}) {
    const Plate one(outside_all_discs(radius_mm), 0);
    const Plate other(outside_all_discs(radius_mm), 0.05);
    ClearedMap map(ClearingOptions{});
    map.add(one.placed(0));
    map.add(other.placed(1));
    const auto scans = map.scans();
    const SurfaceCover cover(scans);
    const auto holes = inner_holes(cover);
    for (int k = 0; k < kHolesAcross * kHolesAcross; ++k) {
      const Eigen::Vector2d middle = middle_of_hole(k / kHolesAcross, k % kHolesAcross);
      const bool found = std::ranges::any_of(holes, [&](const Hole& hole) {
        return std::ranges::any_of(hole.rim, [&](std::uint32_t i) {
          return (cover.rims()[i].position_mm.head<2>() - middle).norm() < radius_mm + 4 * kSpacingMm;
        });
      });
      EXPECT_TRUE(found) << "hole of " << 2 * radius_mm << " mm at " << middle.transpose();
    }
  }
  const auto everywhere = [](double, double) { return true; };
  const Plate one(everywhere, 0);
  const Plate other(everywhere, 0.05);
  const PlacedScan whole[] = {one.placed(0), other.placed(1)};
  EXPECT_TRUE(inner_holes(SurfaceCover(whole)).empty());
}

TEST(SurfaceCover, HolesAreTheSameBesideSomethingFarAway) {
  // The box around both is so large that its cells are larger than the reach.
  const Plate plate(outside_all_discs(0.5), 0);
  const Plate far([](double, double) { return true; }, 0);
  PlacedScan there = far.placed(1);
  there.model_from_scanner.translation_mm = {200, 200, 200};
  const PlacedScan alone[] = {plate.placed(0)};
  const PlacedScan both[] = {plate.placed(0), there};
  const auto rims_of = [](const SurfaceCover& cover) {
    return std::ranges::count_if(cover.rims(), [](const Rim& rim) { return rim.position_mm.norm() < 50; });
  };
  EXPECT_EQ(rims_of(SurfaceCover(both)), rims_of(SurfaceCover(alone)));
}

TEST(SurfaceCover, ACoarseScanLetsGapsPassWhereItLookedAndNowhereElse) {
  const auto outside_both = [](double x, double y) {
    return outside_disc(x - 3, y, 0.45) && outside_disc(x + 3, y, 0.45);
  };
  const Plate one(outside_both, 0);
  const Plate other(outside_both, 0.05);
  const Plate coarse([](double x, double) { return x > 0; }, 0, 0.4);
  ClearedMap map(ClearingOptions{});
  map.add(one.placed(0));
  map.add(other.placed(1));
  map.add(coarse.placed(2));
  const auto scans = map.scans();
  const SurfaceCover cover(scans);
  EXPECT_EQ(cover.spacing_mm_at({-3, 0, 0}), kSpacingMm);
  EXPECT_EQ(cover.spacing_mm_at({3, 0, 0}), 0.4);
  const auto holes = inner_holes(cover);
  ASSERT_EQ(holes.size(), 1U);
  EXPECT_LT(cover.rims()[holes[0].rim.front()].position_mm.x(), 0);

  // The verdict of that place is the one that the fine scans give alone.
  const auto red_at_hole = [](std::span<const PlacedScan> of, double x) {
    JobContext job;
    const auto result = make_red_map(of, nullptr, nullptr, {}, job);
    double red_mm2 = 0;
    for (const RedTarget& t : result->targets.targets) {
      const double away_mm = (t.position_mm - Eigen::Vector3d(x, 0, 0)).norm();
      red_mm2 += t.state == RegionState::kRed && away_mm < 1.0 ? t.area_mm2 : 0.0;
    }
    return red_mm2;
  };
  const std::span<const PlacedScan> fine = std::span(scans).first(2);
  EXPECT_GT(red_at_hole(fine, -3), 0.1);
  EXPECT_NEAR(red_at_hole(scans, -3), red_at_hole(fine, -3), 0.05);
  EXPECT_EQ(red_at_hole(scans, 3), 0.0);
}

TEST(SurfaceCover, PartsAreWhatHangsTogether) {
  const Plate large([](double, double) { return true; }, 0);
  const Plate small([](double x, double) { return x > 0; }, 0);
  PlacedScan scans[] = {small.placed(0), large.placed(1)};
  for (const double apart_mm : {1.0, 0.25}) {
    scans[0].model_from_scanner.translation_mm.z() = apart_mm;
    const SurfaceCover cover(scans);
    ASSERT_EQ(cover.parts().size(), apart_mm > 0.5 ? 2U : 1U);
    EXPECT_EQ(std::accumulate(cover.parts().begin(), cover.parts().end(), std::size_t{0}), cover.size());
    EXPECT_GE(cover.parts().front(), cover.parts().back());
    for (const SurfaceCover::Element& e : cover.elements()) {
      EXPECT_EQ(e.part, cover.parts().size() > 1 && e.position_mm.z() > 0.1F ? 1U : 0U);
    }
    for (const Hole& hole : cover.holes()) {
      for (const std::uint32_t i : hole.rim) {
        const Rim& rim = cover.rims()[i];
        EXPECT_EQ(rim.part, cover.parts().size() > 1 && rim.position_mm.z() > 0.1 ? 1U : 0U);
      }
    }
  }
}

TEST(SettleClosed, SettlesWhatLiesOnClosedSurfaceAndLoneStraysOnly) {
  const Plate plate([](double x, double y) { return outside_disc(x, y, 1.0); }, 0);
  const PlacedScan scans[] = {plate.placed(0)};
  const SurfaceCover cover(scans);
  RedTargets red;
  red.cell_mm = 0.3;
  const Eigen::Vector3d places[] = {{3, 3, 0}, {1.1, 0, 0}, {3, -3, 2}, {-3, -3, 2}};
  const std::size_t samples[] = {1, 1, 2, 20};
  for (std::uint32_t t = 0; t < 4; ++t) {
    RedTarget target;
    target.position_mm = target.sample_mm = places[t];
    target.area_mm2 = 0.1;
    red.targets.push_back(target);
    for (std::size_t k = 0; k < samples[t]; ++k) {
      red.samples.push_back({0, static_cast<std::uint32_t>(100 * t + 3 * k), t});
    }
  }
  settle_closed(scans, cover, 0.02, 3, red);
  EXPECT_EQ(red.targets[0].state, RegionState::kExcused) << "on closed surface";
  EXPECT_EQ(red.targets[0].area_mm2, 0);
  EXPECT_EQ(red.targets[1].state, RegionState::kRed) << "at the rim of a hole";
  EXPECT_EQ(red.targets[2].state, RegionState::kExcused) << "two samples in the air";
  EXPECT_EQ(red.targets[3].state, RegionState::kRed) << "twenty samples in the air are an object";
}

}  // namespace
}  // namespace dubsar
