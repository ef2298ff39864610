// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Vertices that many faces meet at.
#include "triangulation/vertex_fans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "triangulation/manifold.h"
#include "triangulation/mesh_check.h"

namespace dubsar {
namespace {

/// `count` faces around vertex 0, closed.
Mesh cone(std::uint32_t count) {
  Mesh mesh;
  mesh.positions.emplace_back(0.0F, 0.0F, 10.0F);
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto angle_rad = static_cast<float>(2 * std::numbers::pi * k / count);
    mesh.positions.emplace_back(20 * std::cos(angle_rad), 20 * std::sin(angle_rad), 0.0F);
    mesh.faces.push_back({0, 1 + k, 1 + (k + 1) % count});
  }
  return mesh;
}

template <class Value>
void shuffle(std::vector<Value>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) {
    std::swap(values[i - 1], values[random.below(i)]);
  }
}

TEST(VertexFans, AreNumberedInTheOrderOfTheirFirstFaces) {
  // A closed fan of 50, open ones of 20 and 1.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    std::vector<Triangle> faces = cone(50).faces;
    for (std::uint32_t k = 0; k < 20; ++k) {
      faces.push_back({0, 100 + k, 101 + k});
    }
    faces.push_back({0, 200, 201});
    shuffle(faces, random);
    std::vector<std::uint32_t> fan;
    ASSERT_EQ(number_fans(faces, HalfEdges(faces, 202), 0, fan), 3U);
    std::uint32_t next = 0;
    std::vector<std::uint32_t> number(3, 3);  // of the fan of that many vertices in a hundred
    for (std::size_t i = 0; i < faces.size(); ++i) {
      std::uint32_t& of = number[faces[i][1] / 100];
      of = of == 3 ? next++ : of;
      EXPECT_EQ(fan[i], of);
    }
  }
}

TEST(VertexFans, HalfEdgesAreFoundInACrowd) {
  Random random(5);
  std::vector<Triangle> faces;
  while (faces.size() < 3000) {
    const Triangle f = {static_cast<std::uint32_t>(random.below(3)),
                        3 + static_cast<std::uint32_t>(random.below(40)),
                        43 + static_cast<std::uint32_t>(random.below(40))};
    faces.push_back(random.below(2) == 0 ? f : Triangle{f[0], f[2], f[1]});
  }
  const HalfEdges edges(faces, 83);
  for (std::uint32_t a = 0; a < 83; ++a) {
    for (std::uint32_t b = 0; b < 83; ++b) {
      std::vector<std::uint32_t> along;
      for (std::uint32_t i = 0; i < faces.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (faces[i][k] == a && faces[i][(k + 1) % 3] == b) {
            along.push_back(i);
          }
        }
      }
      ASSERT_EQ(edges.count(a, b), static_cast<int>(along.size()));
      ASSERT_EQ(edges.face(a, b), along.empty() ? -1 : static_cast<std::int64_t>(along.front()));
      std::vector<std::uint32_t> seen;
      EXPECT_FALSE(edges.any_face(a, b, [&](std::uint32_t face) {
        seen.push_back(face);
        return false;
      }));
      ASSERT_EQ(seen, along);
    }
  }
}

TEST(VertexFans, ManyFacesAtAVertexTakeNoLongerThanElsewhere) {
  // Where each looked through all others a tenth as many took twenty seconds: these would take half an hour,
  // which the time that any test is granted ends.
  Mesh mesh = cone(600000);
  const MeshReport report = check_manifold(mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.boundary_edges, 600000U);
  EXPECT_TRUE(make_manifold(mesh.faces, mesh.positions.size()).empty());
}

TEST(VertexFans, OfRepeatedFacesInACrowdOneStays) {
  Mesh mesh = cone(100);
  const Mesh once = mesh;
  mesh.faces.push_back({0, 8, 9});
  mesh.faces.push_back({8, 9, 0});
  const MeshReport report = check_manifold(mesh);
  EXPECT_EQ(report.duplicate_faces, 2U);
  EXPECT_EQ(report.non_manifold_edges, 3U);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
  EXPECT_TRUE(make_manifold(mesh.faces, mesh.positions.size()).empty());
  EXPECT_EQ(mesh.faces, once.faces);
}

}  // namespace
}  // namespace dubsar
