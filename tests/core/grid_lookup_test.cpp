// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_lookup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"
#include "tests/support/height_field.h"

namespace dubsar {
namespace {

std::int64_t nearest_by_search(const RangeGrid& grid, const Eigen::Vector3f& p, float radius) {
  float best2 = radius * radius;
  std::int64_t best = -1;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && (grid.point(i) - p).squaredNorm() < best2) {
      best2 = (grid.point(i) - p).squaredNorm();
      best = static_cast<std::int64_t>(i);
    }
  }
  return best;
}

/// Uneven spacing, holes and a step: what real scans look like.
RangeGrid warped_grid(std::uint64_t seed) {
  Random random(seed);
  RangeGrid grid = test::height_field(40, 50, 0.2, [&](double x, double y) {
    return std::sin(x) + 0.3 * y + (x > 2 ? 4.0 : 0.0) + 0.02 * random.normal();
  });
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] += static_cast<float>(0.08 * random.normal());
    grid.y[i] += static_cast<float>(0.08 * random.normal());
    grid.valid[i] = random.uniform() < 0.9 ? 1 : 0;
  }
  return grid;
}

TEST(GridLookup, AgreesWithASearchThroughAll) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RangeGrid grid = warped_grid(seed);
    grid.view.direction = Eigen::Vector3d(0.1 * static_cast<double>(seed), 0.2, -1).normalized();
    const GridLookup lookup(grid);
    Random random(seed + 100);
    int found = 0;
    for (int k = 0; k < 500; ++k) {
      const Eigen::Vector3f p{static_cast<float>(random.uniform(-7, 7)),
                              static_cast<float>(random.uniform(-6, 6)),
                              static_cast<float>(random.uniform(-3, 6))};
      const auto radius = static_cast<float>(random.uniform(0.05, 3.0));
      const std::int64_t expected = nearest_by_search(grid, p, radius);
      EXPECT_EQ(lookup.nearest(p, radius), expected);
      found += expected >= 0 ? 1 : 0;
    }
    EXPECT_GT(found, 100);
  }
}

/// With fetching before, which must not read outside: where nothing is, too, and of no number.
TEST(GridLookup, WhatIsFoundComesWithWhereItLies) {
  const RangeGrid grid = warped_grid(4);
  const GridLookup lookup(grid);
  Random random(104);
  for (int k = 0; k < 200; ++k) {
    Eigen::Vector3f p{static_cast<float>(random.uniform(-20, 20)),
                      static_cast<float>(random.uniform(-20, 20)), static_cast<float>(random.uniform(-3, 6))};
    p.x() = k == 7 ? std::numeric_limits<float>::quiet_NaN() : p.x();
    const auto radius = static_cast<float>(random.uniform(0.05, 3.0));
    lookup.fetch_buckets(p);
    lookup.fetch_samples(p, radius);
    const GridLookup::Found found = lookup.find_nearest(p, radius);
    EXPECT_EQ(found.sample, lookup.nearest(p, radius));
    if (found.sample >= 0) {
      EXPECT_EQ(found.point_mm, grid.point(static_cast<std::size_t>(found.sample)));
    }
  }
}

TEST(GridLookup, AgreesWhereSamplesAreFewAndFarApart) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RangeGrid grid = warped_grid(seed);
    Random random(seed + 40);
    grid.view.direction = Eigen::Vector3d{random.normal(), random.normal(), -1}.normalized();
    for (std::uint8_t& valid : grid.valid) {
      valid = valid != 0 && random.uniform() < 0.01 ? 1 : 0;
    }
    if (seed > 3) {  // one sample out of this world, and a few that are merely far away
      grid.valid[11] = grid.valid[12] = grid.valid[900] = 1;
      grid.x[11] = 1e6F;
      grid.y[12] = -300.0F;
      grid.z[900] = 80.0F;
    }
    const GridLookup lookup(grid, {}, 0.05);
    int found = 0;
    for (int k = 0; k < 600; ++k) {
      const double spread = k % 3 == 0 ? 400.0 : 8.0;
      const Eigen::Vector3f p{static_cast<float>(random.uniform(-spread, spread)),
                              static_cast<float>(random.uniform(-spread, spread)),
                              static_cast<float>(random.uniform(-spread, spread))};
      const auto radius = static_cast<float>(random.uniform(0.5, k % 2 == 0 ? 10.0 : 500.0));
      const std::int64_t expected = nearest_by_search(grid, p, radius);
      EXPECT_EQ(lookup.nearest(p, radius), expected) << "seed " << seed << " radius " << radius;
      found += expected >= 0 ? 1 : 0;
    }
    EXPECT_GT(found, 200);
    EXPECT_LT(found, 590);
    EXPECT_GE(lookup.nearest({0, 0, 0}, std::numeric_limits<float>::infinity()), 0);
  }
}

TEST(GridLookup, AgreesFarFromTheOrigin) {
  RangeGrid grid = warped_grid(4);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] += 50000.0F;
    grid.y[i] -= 20000.0F;
  }
  grid.view.direction = Eigen::Vector3d(0.3, 0.2, -1).normalized();
  const GridLookup lookup(grid);
  Random random(7);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3f p{50000.0F + static_cast<float>(random.uniform(-7, 7)),
                            -20000.0F + static_cast<float>(random.uniform(-6, 6)),
                            static_cast<float>(random.uniform(-3, 6))};
    EXPECT_EQ(lookup.nearest(p, 1.0F), nearest_by_search(grid, p, 1.0F));
  }
}

TEST(GridLookup, OnlyKeptSamplesAnswer) {
  const RangeGrid grid = test::height_field(5, 5, 1.0, [](double, double) { return 0.0; });
  std::vector<std::uint8_t> keep(grid.size(), 0);
  keep[grid.index(1, 3)] = 1;
  const GridLookup lookup(grid, keep);
  EXPECT_EQ(lookup.nearest({0, 0, 0}, 10), static_cast<std::int64_t>(grid.index(1, 3)));
}

TEST(GridLookup, EmptyFarAndNotANumber) {
  RangeGrid grid = test::height_field(3, 3, 1.0, [](double, double) { return 0.0; });
  EXPECT_EQ(GridLookup(grid).nearest({1e9F, 0, 0}, 5), -1);
  EXPECT_EQ(GridLookup(grid).nearest({std::nanf(""), 0, 0}, 5), -1);
  grid.valid.assign(grid.size(), 0);
  EXPECT_EQ(GridLookup(grid).nearest({0, 0, 0}, 5), -1);
  EXPECT_EQ(GridLookup(RangeGrid{}).nearest({0, 0, 0}, 5), -1);
}

TEST(GridLookup, OneOutlierDoesNotBlowUpTheRaster) {
  RangeGrid grid = test::height_field(20, 20, 0.1, [](double, double) { return 0.0; });
  grid.x[7] = 1e6F;
  const GridLookup lookup(grid);
  EXPECT_EQ(lookup.nearest(grid.point(210), 0.01F), 210);
  EXPECT_EQ(lookup.nearest({1e6F, grid.y[7], 0}, 1.0F), 7);
  EXPECT_LT(lookup.cell_mm(), 1.0);
  int seen = 0;
  lookup.for_each_near({1e6F, grid.y[7], 0}, 1.0F, [&](std::size_t i) { seen += i == 7 ? 1 : 0; });
  EXPECT_EQ(seen, 1);
}

TEST(GridLookup, VisitsAllWithinTheRadius) {
  const RangeGrid grid = warped_grid(9);
  const GridLookup lookup(grid);
  const Eigen::Vector3f p(0.3F, -0.4F, 0.2F);
  int near = 0;
  lookup.for_each_near(p, 1.0F, [&](std::size_t i) { near += (grid.point(i) - p).norm() < 1.0F ? 1 : 0; });
  int expected = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    expected += grid.valid[i] != 0 && (grid.point(i) - p).norm() < 1.0F ? 1 : 0;
  }
  EXPECT_EQ(near, expected);
  EXPECT_GT(near, 10);
}

TEST(GridLookup, AnyWithinIsWhatASearchThroughAllFinds) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RangeGrid grid = warped_grid(seed);
    const GridLookup lookup(grid);
    Random random(seed + 200);
    for (int k = 0; k < 500; ++k) {
      const Eigen::Vector3f p{static_cast<float>(random.uniform(-7, 7)),
                              static_cast<float>(random.uniform(-6, 6)),
                              static_cast<float>(random.uniform(-3, 6))};
      const auto radius = static_cast<float>(random.uniform(0.05, 1.0));
      const std::size_t third = random.below(3);
      bool expected = false;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        expected = expected || (grid.valid[i] != 0 && i % 3 == third &&
                                (grid.point(i) - p).squaredNorm() <= radius * radius);
      }
      const GridLookup::Reach reach = lookup.reach_of(p, radius);
      const bool found = lookup.may_hold_samples(reach) &&
                         lookup.any_within(reach, [&](std::uint32_t i) { return i % 3 == third; });
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(GridLookup, ALargeGridBuiltInPartsHoldsEverySampleInOrder) {
  Random random(4);
  RangeGrid grid = test::height_field(700, 900, 0.1, [&](double x, double) { return std::sin(x); });
  for (std::uint8_t& valid : grid.valid) {
    valid = random.uniform() < 0.9 ? 1 : 0;
  }
  const GridLookup lookup(grid);
  std::size_t seen = 0;
  std::vector<std::uint8_t> times(grid.size(), 0);
  lookup.for_each_near({0, 0, 0}, 1e3F, [&](std::size_t i) {
    ++times[i];
    ++seen;
  });
  EXPECT_EQ(seen, grid.valid_count());
  EXPECT_EQ(times, grid.valid);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3f p{static_cast<float>(random.uniform(-45, 45)),
                            static_cast<float>(random.uniform(-35, 35)), 0};
    std::int64_t before = -1;
    lookup.for_each_near(p, 0.0F, [&](std::size_t i) {  // one bucket
      EXPECT_GT(static_cast<std::int64_t>(i), before);
      before = static_cast<std::int64_t>(i);
    });
  }
}

}  // namespace
}  // namespace dubsar
