// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/reachable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

/// Four walls around a shaft of the given width, open at the top, with a floor.
SimTablet shaft(float half_width, float depth) {
  SimTablet tablet;
  const float w = half_width;
  const Eigen::Vector3f down(0, 0, -depth);
  const Eigen::Vector3f a(-w, -w, 0);
  const Eigen::Vector3f b(w, -w, 0);
  const Eigen::Vector3f c(w, w, 0);
  const Eigen::Vector3f d(-w, w, 0);
  add_quad(&tablet, a, b, b + down, a + down, 0.6F);
  add_quad(&tablet, b, c, c + down, b + down, 0.6F);
  add_quad(&tablet, c, d, d + down, c + down, 0.6F);
  add_quad(&tablet, d, a, a + down, d + down, 0.6F);
  add_quad(&tablet, a + down, b + down, c + down, d + down, 0.6F);
  return tablet;
}

double share(const SimTablet& made) {
  const TestScene scene(made);
  JobContext job;
  ReachOptions options;
  options.samples = 4000;
  const Result<Reach> reach = reachable_surface(scene.tablet, scene.query, {}, options, job);
  EXPECT_TRUE(reach);
  EXPECT_EQ(reach->points.size(), 4000U);
  return reach->share;
}

TEST(Reachable, AllOfAnOpenPlaneAndLittleOfADeepShaft) {
  EXPECT_EQ(share(plane(10, 0, 0.6F)), 1.0);
  EXPECT_EQ(share(shaft(10, 1)), 1.0);
  // A slope of at most 70.5° lets nobody look deeper into a shaft than its width times the tangent of that;
  // along the diagonal the width is greater by sqrt(2), but both neighbouring walls are then seen flatter.
  const TestScene scene(shaft(0.5F, 5));
  JobContext job;
  const Result<Reach> reach = reachable_surface(scene.tablet, scene.query, {}, {}, job);
  ASSERT_TRUE(reach);
  EXPECT_GT(reach->share, 0.1);
  for (std::size_t i = 0; i < reach->points.size(); ++i) {
    const bool wall = std::abs(reach->normals[i].z()) < 0.5F;
    // Next to a corner a ray may leave through the bare wall, which here has no clay behind it.
    const float along = std::min(std::abs(reach->points[i].x()), std::abs(reach->points[i].y()));
    if (reach->reachable[i] != 0 && wall && along < 0.4F && reach->points[i].z() > -4.9F) {
      EXPECT_GT(reach->points[i].z(), -2.83F);
    }
    if (wall && reach->points[i].z() > -0.5F && std::abs(reach->points[i].x()) < 0.3F) {
      EXPECT_NE(reach->reachable[i], 0);
    }
  }
}

TEST(Reachable, NearlyAllOfATablet) {
  TabletOptions options = small_clean_tablet();
  options.spacing_mm = 0.25;
  EXPECT_GT(share(make_or_fail(options)), 0.99);
}

TEST(Reachable, AnEmptyMeshHasNothingAndACancelledJobStops) {
  JobContext job;
  const SimTablet none;
  const MeshQuery query(none.mesh);
  const Result<Reach> reach = reachable_surface(none, query, {}, {}, job);
  ASSERT_TRUE(reach);
  EXPECT_TRUE(reach->points.empty());
  job.cancel();
  const TestScene scene(plane(10, 0, 0.6F));
  EXPECT_EQ(reachable_surface(scene.tablet, scene.query, {}, {}, job).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar::sim
