// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Cuts around vertices that very many faces meet at.
#include "triangulation/crowded_vertices.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/mesh.h"
#include "core/random.h"
#include "tests/triangulation/support/comparisons_of.h"
#include "triangulation/face_cut.h"
#include "triangulation/self_intersections.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::uint32_t add_vertex(Mesh& mesh, const Vector3f& p) {
  mesh.positions.push_back(p);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

Vector3f drawn(Random& random, double size) {
  return (size * random.normal3()).cast<float>();
}

void add_loose_faces(Mesh& mesh, int count, double size, Random& random) {
  for (int k = 0; k < count; ++k) {
    const Vector3f middle = drawn(random, 5);
    std::array<std::uint32_t, 3> face{};
    for (std::uint32_t& corner : face) {
      corner = add_vertex(mesh, middle + drawn(random, size));
    }
    mesh.faces.push_back(face);
  }
}

/// Faces between a vertex and a ring of others, closed.
void add_fan(Mesh& mesh, std::uint32_t vertex, std::uint32_t ring, std::uint32_t count) {
  for (std::uint32_t k = 0; k < count; ++k) {
    mesh.faces.push_back({vertex, ring + k, ring + (k + 1) % count});
  }
}

/// A tilted cone with a bottom: two vertices at which `count` faces meet.
Mesh cone(std::uint32_t count) {
  Mesh mesh;
  const Eigen::AngleAxisf tilt(0.7F, Vector3f(1, 2, 0.5F).normalized());
  const std::uint32_t tip = add_vertex(mesh, tilt * Vector3f(0, 0, 6));
  const std::uint32_t middle = add_vertex(mesh, {0, 0, 0});
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto angle_rad = static_cast<float>(2 * std::numbers::pi * k / count);
    add_vertex(mesh, tilt * Vector3f(8 * std::cos(angle_rad), 8 * std::sin(angle_rad), 0));
  }
  add_fan(mesh, tip, 2, count);
  add_fan(mesh, middle, 2, count);
  return mesh;
}

/// Each pair of faces, looked at.
Pairs each_pair(const Mesh& mesh) {
  Pairs out;
  for (std::uint32_t a = 0; a < mesh.faces.size(); ++a) {
    for (std::uint32_t b = a + 1; b < mesh.faces.size(); ++b) {
      if (faces_cut(mesh.positions, mesh.faces[a], FacePlane(mesh.positions, mesh.faces[a]), mesh.faces[b])) {
        out.emplace_back(a, b);
      }
    }
  }
  return out;
}

void expect_all_found(const Mesh& mesh, std::size_t at_least) {
  const Pairs each = each_pair(mesh);
  EXPECT_GE(each.size(), at_least);
  EXPECT_EQ(self_intersections(mesh.positions, mesh.faces), each);
}

TEST(CrowdedVertices, AWholeConeHasNoCut) {
  EXPECT_TRUE(each_pair(cone(150)).empty());
  expect_all_found(cone(150), 0);
}

TEST(CrowdedVertices, AConeThatOthersPierce) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Random random(seed);
    Mesh mesh = cone(120);
    add_loose_faces(mesh, 100, 0.5, random);
    add_loose_faces(mesh, 30, 8, random);
    expect_all_found(mesh, 50);
  }
}

/// Thin and wide ones across each other, some of them around the vertex nearly to its other side.
TEST(CrowdedVertices, FacesOfOneVertexThatCrossEachOther) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Random random(seed);
    Mesh mesh;
    const std::uint32_t vertex = add_vertex(mesh, drawn(random, 3));
    for (int k = 0; k < 150; ++k) {
      const Vector3f a = drawn(random, 4);
      const Vector3f b = k % 3 == 0 ? Vector3f(-a + drawn(random, 0.5)) : Vector3f(a + drawn(random, 1));
      const std::uint32_t first = add_vertex(mesh, mesh.positions[vertex] + a);
      mesh.faces.push_back({first, vertex, add_vertex(mesh, mesh.positions[vertex] + b)});
    }
    add_loose_faces(mesh, 20, 10, random);
    expect_all_found(mesh, 500);
  }
}

TEST(CrowdedVertices, SeveralThatShareFaces) {
  Random random(9);
  Mesh mesh;
  for (int k = 0; k < 3; ++k) {
    add_vertex(mesh, drawn(random, 3));
  }
  for (std::uint32_t k = 0; k < 300; ++k) {
    const std::uint32_t a = add_vertex(mesh, drawn(random, 4));
    mesh.faces.push_back({k % 3, a, k % 5 == 0 ? (k + 1) % 3 : add_vertex(mesh, drawn(random, 4))});
  }
  expect_all_found(mesh, 500);
}

TEST(CrowdedVertices, FacesWithoutAreaAndVerticesInOnePlace) {
  Random random(5);
  Mesh mesh = cone(100);
  const std::uint32_t again = add_vertex(mesh, mesh.positions[0]);
  mesh.faces.push_back({again, 5, 40});
  mesh.faces.push_back({0, 0, 30});
  mesh.faces.push_back({0, again, 7});
  mesh.faces.push_back({0, add_vertex(mesh, -mesh.positions[0]), again});
  add_loose_faces(mesh, 50, 4, random);
  expect_all_found(mesh, 20);
}

TEST(CrowdedVertices, AreTakenOutWithTheirCuts) {
  Mesh mesh = cone(100);
  Random random(1);
  add_loose_faces(mesh, 40, 4, random);
  std::vector<std::uint32_t> which(mesh.faces.size());
  std::iota(which.begin(), which.end(), 0U);
  EXPECT_FALSE(take_cuts_at_crowded_vertices(mesh.positions, mesh.faces, which).empty());
  EXPECT_EQ(which.size(), 40U);
  EXPECT_EQ(*std::ranges::min_element(which), 200U);
}

/// Faces between two vertices and one more each: pages of a book.
void add_book(Mesh& mesh, std::uint32_t a, std::uint32_t b, int pages, Random& random) {
  for (int k = 0; k < pages; ++k) {
    mesh.faces.push_back({a, b, add_vertex(mesh, drawn(random, 4))});
  }
}

TEST(CrowdedVertices, BooksAtOneVertex) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Random random(seed);
    Mesh mesh;
    for (int k = 0; k < 3; ++k) {
      add_vertex(mesh, drawn(random, 3));
    }
    add_book(mesh, 0, 1, 120, random);
    add_book(mesh, 2, 0, 100, random);
    add_book(mesh, 1, 2, 90, random);
    mesh.faces.push_back({0, 1, 2});
    for (int k = 0; k < 60; ++k) {
      mesh.faces.push_back({add_vertex(mesh, drawn(random, 4)), 0, add_vertex(mesh, drawn(random, 4))});
    }
    add_loose_faces(mesh, 60, 4, random);
    expect_all_found(mesh, 1000);
  }
}

TEST(CrowdedVertices, AreNoWorkOfTheirSquare) {
  const std::size_t half = test::comparisons_of(cone(2000));
  EXPECT_GT(half, 4000U);
  EXPECT_LT(test::comparisons_of(cone(4000)), 2.6 * static_cast<double>(half));
}

TEST(CrowdedVertices, NorAreCrowdedEdges) {
  const auto book = [](int pages) {
    Mesh mesh;
    Random random(2);
    add_vertex(mesh, {0, 0, 0});
    add_vertex(mesh, {1, 0, 0});
    add_book(mesh, 0, 1, pages, random);
    return test::comparisons_of(mesh);
  };
  EXPECT_LE(book(4000), 2.6 * static_cast<double>(book(2000)) + 1000);
}

}  // namespace
}  // namespace dubsar
