// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/integral_invariants.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

/// f at one vertex by scale.
std::vector<float> at(const IntegralInvariants& invariants, std::size_t v) {
  const std::size_t scales = invariants.radii_mm.size();
  const auto first = invariants.value.begin() + static_cast<std::ptrdiff_t>(v * scales);
  return {first, first + static_cast<std::ptrdiff_t>(scales)};
}

IntegralInvariants of_sheet(const Mesh& mesh, const Eigen::Vector3f& up, double edge_mm) {
  const JobContext job;
  return integral_invariants(mesh, std::vector<Eigen::Vector3f>(mesh.positions.size(), up.normalized()),
                             edge_mm, {}, job);
}

TEST(IntegralInvariants, ScalesAreThoseOfGigaMesh) {
  const JobContext job;
  const IntegralInvariants none = integral_invariants({}, {}, 0.1, {2.0, 2}, job);
  EXPECT_EQ(none.radii_mm, (std::vector<float>{2.0F, 1.5F, 1.0F, 0.5F}));
}

TEST(IntegralInvariants, OnATiltedPlaneAreNone) {
  const Mesh mesh = shapes::sheet(4, 160, [](float x, float y) { return 0.3F * x - 0.2F * y; });
  const IntegralInvariants plane = of_sheet(mesh, {-0.3F, 0.2F, 1}, 0.05);
  for (const std::size_t v : {80U * 161 + 80, 81U * 161 + 77, 90U * 161 + 93}) {
    const std::vector<float> f = at(plane, v);
    for (std::size_t s = 0; s < 15; ++s) {  // the sixteenth sphere is one pixel
      EXPECT_NEAR(f[s], 0, 0.03) << s;
    }
  }
}

/// On a sphere of radius ρ, f(r) = −3r / (8ρ): the lens of two spheres, one through the other's centre.
TEST(IntegralInvariants, OnASphereAreThoseOfTheLens) {
  constexpr float kRadius = 5;
  const Mesh mesh = shapes::sphere(kRadius, 7);
  std::vector<Eigen::Vector3f> outlook;
  for (const Eigen::Vector3f& p : mesh.positions) {
    outlook.push_back(p.normalized());
  }
  const JobContext job;
  const IntegralInvariants sphere = integral_invariants(mesh, outlook, 0.06, {}, job);
  for (std::size_t v = 0; v < mesh.positions.size(); v += 997) {
    const std::vector<float> f = at(sphere, v);
    for (std::size_t s = 0; s < f.size() && sphere.radii_mm[s] > 0.25F; ++s) {
      ASSERT_NEAR(f[s], -3 * sphere.radii_mm[s] / (8 * kRadius), 0.012) << v << ' ' << s;
    }
  }
}

TEST(IntegralInvariants, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::sphere(5, 6);
  std::vector<Eigen::Vector3f> outlook;
  for (const Eigen::Vector3f& p : mesh.positions) {
    outlook.push_back(p.normalized());
  }
  const JobContext job;
  const IntegralInvariants many = integral_invariants(mesh, outlook, 0.12, {}, job);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(many.value == integral_invariants(mesh, outlook, 0.12, {}, job).value);
}

TEST(IntegralInvariants, OnAPlaneAreNoneUpToItsBorderAndRoundAHole) {
  Mesh mesh = shapes::sheet(4, 160, [](float x, float y) { return 0.3F * x - 0.2F * y; });
  std::erase_if(mesh.faces, [](const auto& f) {
    const auto in = [](std::uint32_t v) {
      return v / 161 > 70 && v / 161 < 90 && v % 161 > 70 && v % 161 < 90;
    };
    return in(f[0]) || in(f[1]) || in(f[2]);
  });
  const IntegralInvariants plane = of_sheet(mesh, {-0.3F, 0.2F, 1}, 0.05);
  for (const std::size_t v :
       {80U, 80U * 161, 5U * 161 + 40, 70U * 161 + 80, 65U * 161 + 80, 0U, 161U * 161 - 1}) {
    const std::vector<float> f = at(plane, v);
    for (std::size_t s = 0; s < 12; ++s) {  // radii above 0.25 mm
      EXPECT_NEAR(f[s], 0, 0.03) << v << ' ' << s;
    }
  }
  // The ridge beside a border is as sharp as any.
  const Mesh ridge = shapes::sheet(4, 160, [](float x, float) { return -std::abs(x); });
  const std::vector<float> f = at(of_sheet(ridge, {0, 0, 1}, 0.05), 80);
  for (std::size_t s = 0; s < 12; ++s) {
    EXPECT_NEAR(f[s], -0.5, 0.06) << s;
  }
}

/// At the bottom of a V of half-angle 45° three quarters of the sphere are clay, whatever its size.
TEST(IntegralInvariants, InAValleyAndOnARidgeAreOppositeAndTheSameAtAllScales) {
  const Mesh valley = shapes::sheet(4, 160, [](float x, float) { return std::abs(x); });
  const Mesh ridge = shapes::sheet(4, 160, [](float x, float) { return -std::abs(x); });
  const std::size_t middle = 80 * 161 + 80;
  const std::vector<float> below = at(of_sheet(valley, {0, 0, 1}, 0.05), middle);
  const std::vector<float> above = at(of_sheet(ridge, {0, 0, 1}, 0.05), middle);
  for (std::size_t s = 0; s < 12; ++s) {  // radii above 0.25 mm
    EXPECT_NEAR(below[s], 0.5, 0.05) << s;
    EXPECT_NEAR(above[s], -0.5, 0.05) << s;
  }
}

TEST(IntegralInvariants, TheStrongestResponseKeepsItsSign) {
  IntegralInvariants invariants;
  invariants.radii_mm = {1, 0.5F};
  invariants.value = {0.2F, -0.3F, 0.1F, 0.0F};
  invariants.resolved_mm = 0.4;
  EXPECT_EQ(strongest_response(invariants), (std::vector<float>{-0.3F, 0.1F}));
}

}  // namespace
}  // namespace dubsar
