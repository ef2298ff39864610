// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/nearest_usable.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/random.h"
#include "tests/registration/support/field_views.h"

namespace dubsar {
namespace {

/// On the surface, above it, beside the field, far away, and no number: more than are fetched at once, and no
/// multiple of it.
std::vector<Eigen::Vector3f> points_about(const SurfaceLevel& level) {
  Random random(3);
  std::vector<Eigen::Vector3f> points;
  for (const SurfaceSample& sample : level.samples) {
    const double off_mm = random.uniform() < 0.8 ? 0.3 : 8.0;
    points.emplace_back(sample.position_mm + (off_mm * random.normal3()).cast<float>());
  }
  points.emplace_back(1e6F, 0, 0);
  points.emplace_back(0, std::numeric_limits<float>::quiet_NaN(), 0);
  if (points.size() % 32 == 0) {
    points.emplace_back(0, 0, 0);
  }
  return points;
}

TEST(NearestUsable, OfManyAtOnceIsThatOfEach) {
  const PlacedSurface view = testing::field_views(1).front();
  for (const SurfaceLevel* level : {view.surface->fine.get(), view.surface->coarse.get()}) {
    const std::vector<Eigen::Vector3f> points = points_about(*level);
    for (const float reach_mm : {0.2F, 1.0F, 5.0F}) {
      std::vector<GridLookup::Found> found(points.size());
      nearest_usable(*level, points, reach_mm, found);
      std::size_t hits = 0;
      for (std::size_t k = 0; k < points.size(); ++k) {
        EXPECT_EQ(found[k].sample, nearest_usable(*level, points[k], reach_mm)) << k;
        if (found[k].sample >= 0) {
          const auto j = static_cast<std::size_t>(found[k].sample);
          EXPECT_EQ(found[k].point_mm, level->grid.point(j));
          EXPECT_NE(level->usable[j], 0);
          ++hits;
        }
      }
      EXPECT_GT(hits, 10U);
      EXPECT_LT(hits, points.size());
    }
  }
}

}  // namespace
}  // namespace dubsar
