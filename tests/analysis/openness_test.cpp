// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/openness.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

std::vector<float> openness_of(const Mesh& mesh, const OpennessOptions& options = {}) {
  const JobContext job;
  return vertex_openness(mesh, make_vertex_geometry(mesh, make_vertex_graph(mesh)), options, job);
}

TEST(Openness, AConvexBodyIsOpenEverywhere) {
  for (const float o : openness_of(shapes::sphere(20, 6))) {
    ASSERT_GT(o, 0.95F);
  }
}

TEST(Openness, WhatIsOfNoFaceHidesNothing) {
  Mesh mesh = shapes::sphere(20, 6);
  const std::size_t of_faces = mesh.positions.size();
  for (std::size_t v = 0; v < of_faces; ++v) {  // left over by a program that deleted faces only
    mesh.positions.push_back(1.1F * mesh.positions[v]);
  }
  const std::vector<float> openness = openness_of(mesh);
  for (std::size_t v = 0; v < of_faces; ++v) {
    ASSERT_GT(openness[v], 0.95F);
  }
}

/// On the floor of a round shaft of depth d and radius a, in its middle, the sky is the cap within atan(a/d):
/// by the cosine, sin² of it of the whole.
TEST(Openness, OnTheFloorOfAShaftIsTheShareOfTheSky) {
  constexpr float kRadius = 2;
  for (const float depth : {1.0F, 2.0F, 4.0F}) {
    const Mesh mesh = shapes::sheet(8, 160, [&](float x, float y) {
      const float past = (std::hypot(x, y) - kRadius) / 0.1F;
      return depth * std::clamp(past, 0.0F, 1.0F);
    });
    OpennessOptions options;
    options.directions = 256;
    const float sky = kRadius * kRadius / (kRadius * kRadius + depth * depth);
    EXPECT_NEAR(openness_of(mesh, options)[80 * 161 + 80], sky, 0.05) << depth;
  }
}

TEST(Openness, ACoarseMeshHasNoHolesInItsShadows) {
  // Ten faces: a roof over a floor. Nothing above the floor's middle is open but the sides.
  Mesh mesh = shapes::sheet(10, 1, [](float, float) { return 0.0F; });
  Mesh roof = shapes::sheet(10, 1, [](float, float) { return 1.0F; });
  mesh.positions.insert(mesh.positions.end(), roof.positions.begin(), roof.positions.end());
  mesh.positions.emplace_back(0, 0, 0);
  mesh.positions.emplace_back(0.5, 0, 0);
  mesh.positions.emplace_back(0, 0.5, 0);
  for (auto f : roof.faces) {
    for (std::uint32_t& v : f) {
      v += 4;
    }
    mesh.faces.push_back(f);
  }
  mesh.faces.push_back({8, 9, 10});
  const std::vector<float> openness = openness_of(mesh);
  EXPECT_LT(openness[8], 0.1F);
  EXPECT_GT(openness[4], 0.95F);
}

TEST(Openness, EqualizingSpreadsItEvenly) {
  std::vector<float> values;
  for (int i = 0; i < 10000; ++i) {
    const float t = static_cast<float>(i) / 9999.0F;
    values.push_back(0.8F + 0.2F * t * t);
  }
  std::vector<float> even = equalized(values);
  EXPECT_TRUE(std::is_sorted(even.begin(), even.end()));
  for (int i = 0; i < 10000; i += 500) {
    EXPECT_NEAR(even[static_cast<std::size_t>(i)], i / 10000.0, 0.05);
  }
}

TEST(Openness, StopsWhenCancelled) {
  JobContext job;
  job.cancel();
  const Mesh mesh = shapes::sphere(5, 3);
  EXPECT_TRUE(vertex_openness(mesh, make_vertex_geometry(mesh, make_vertex_graph(mesh)), {}, job).empty());
}

}  // namespace
}  // namespace dubsar
