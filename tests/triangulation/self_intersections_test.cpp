// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/self_intersections.h"

#include <gtest/gtest.h>

#include <array>
#include <ctime>
#include <limits>

#include "core/mesh.h"
#include "core/random.h"
#include "triangulation/face_cut.h"

namespace dubsar {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs intersections(const Mesh& mesh) {
  return self_intersections(mesh.positions, mesh.faces);
}

void add_face(Mesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.faces.push_back({first, first + 1, first + 2});
}

/// An n by n sheet of squares, each of two faces.
Mesh sheet(int n, float height) {
  Mesh mesh;
  for (int r = 0; r <= n; ++r) {
    for (int c = 0; c <= n; ++c) {
      mesh.positions.emplace_back(static_cast<float>(c), static_cast<float>(r), height);
    }
  }
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) {
      const auto i = static_cast<std::uint32_t>(r * (n + 1) + c);
      const auto below = i + static_cast<std::uint32_t>(n) + 1;
      mesh.faces.push_back({i, i + 1, below});
      mesh.faces.push_back({i + 1, below + 1, below});
    }
  }
  return mesh;
}

TEST(SelfIntersections, TwoFacesThatCross) {
  Mesh mesh;
  add_face(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_face(mesh, {1, 1, -1}, {1, 1, 1}, {9, 9, 1});
  EXPECT_EQ(intersections(mesh), (Pairs{{0, 1}}));
}

/// Depths that come in steps put many samples into exactly one plane, which no sum of their products tells.
TEST(SelfIntersections, FacesOfOnePlaneDoNot) {
  Random random(1);
  const auto draw = [&] {
    const Eigen::Vector3d v = 0.1 * random.normal3();
    constexpr double kSteps = 1U << 22U;  // sums of a few are exact, and their products are not
    return Eigen::Vector3f((kSteps * v).array().round().matrix().cast<float>() / static_cast<float>(kSteps));
  };
  std::size_t found = 0;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3f right = draw();
    const Eigen::Vector3f down = draw();
    Mesh tilted = sheet(4, 0);
    for (Eigen::Vector3f& p : tilted.positions) {
      p = (p.x() * right + p.y() * down).eval();
    }
    found += intersections(tilted).size();
  }
  EXPECT_EQ(found, 0U);
}

TEST(SelfIntersections, TouchingAndParallelFacesDoNot) {
  Mesh mesh;
  add_face(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_face(mesh, {0, 0, 0.01F}, {4, 0, 0.01F}, {0, 4, 0.01F});
  add_face(mesh, {5, 0, -1}, {5, 0, 1}, {5, 5, 0});
  EXPECT_TRUE(intersections(mesh).empty());
  EXPECT_TRUE(intersections(sheet(30, 0)).empty());
}

TEST(SelfIntersections, AFoldAtASharedVertex) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 1, -1}, {1, 2, 1}};
  mesh.faces = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(intersections(mesh), (Pairs{{0, 1}}));
  mesh.faces = {{0, 1, 2}, {0, 1, 4}};  // an edge in common
  EXPECT_TRUE(intersections(mesh).empty());
}

TEST(SelfIntersections, ALongFaceThroughASheetOfSmallOnes) {
  Mesh mesh = sheet(40, 0);
  const auto spear = static_cast<std::uint32_t>(mesh.faces.size());
  add_face(mesh, {20.3F, 20.4F, -500}, {20.3F, 20.4F, 500}, {20.31F, 20.41F, 500});
  const Pairs found = intersections(mesh);
  ASSERT_FALSE(found.empty());
  for (const auto& [a, b] : found) {
    EXPECT_EQ(b, spear);
  }
}

TEST(SelfIntersections, AgreesWithEveryPairLookedAt) {
  Random random(7);
  Mesh mesh;
  for (int k = 0; k < 300; ++k) {
    const auto draw = [&](double size) {
      return Eigen::Vector3f{static_cast<float>(random.uniform(-size, size)),
                             static_cast<float>(random.uniform(-size, size)),
                             static_cast<float>(random.uniform(-size, size))};
    };
    const Eigen::Vector3f middle = draw(5);
    const double size = k % 20 == 0 ? 4.0 : 0.5;
    const std::array<Eigen::Vector3f, 3> corners{middle + draw(size), middle + draw(size),
                                                 middle + draw(size)};
    add_face(mesh, corners[0], corners[1], corners[2]);
  }
  Pairs each;
  for (std::uint32_t a = 0; a < mesh.faces.size(); ++a) {
    for (std::uint32_t b = a + 1; b < mesh.faces.size(); ++b) {
      Mesh two;
      two.positions = mesh.positions;
      two.faces = {mesh.faces[a], mesh.faces[b]};
      if (!intersections(two).empty()) {
        each.emplace_back(a, b);
      }
    }
  }
  EXPECT_GT(each.size(), 20U);
  EXPECT_EQ(intersections(mesh), each);
}

/// Two crowds of small faces a kilometre apart, and a few as long as that.
TEST(SelfIntersections, OfHugeFacesAndFarPlacesNoneIsMissed) {
  Random random(3);
  Mesh mesh;
  const auto drawn = [&](double size) { return Eigen::Vector3f((size * random.normal3()).cast<float>()); };
  for (int k = 0; k < 1500; ++k) {
    const Eigen::Vector3f middle = drawn(3) + Eigen::Vector3f(k % 2 == 0 ? 0.0F : 1e6F, 0, 0);
    const Eigen::Vector3f a = middle + drawn(0.3);
    const Eigen::Vector3f b = middle + drawn(0.3);
    add_face(mesh, a, b, k % 300 == 7 ? Eigen::Vector3f(drawn(1e6)) : Eigen::Vector3f(middle + drawn(0.3)));
  }
  add_face(mesh, {-1e6F, 0, 0.1F}, {2e6F, 0, 0.1F}, {0.5e6F, 1, 0.1F});
  Pairs each;
  for (std::uint32_t a = 0; a < mesh.faces.size(); ++a) {
    const FacePlane plane(mesh.positions, mesh.faces[a]);
    for (std::uint32_t b = a + 1; b < mesh.faces.size(); ++b) {
      if (faces_cut(mesh.positions, mesh.faces[a], plane, mesh.faces[b])) {
        each.emplace_back(a, b);
      }
    }
  }
  EXPECT_GT(each.size(), 60U);
  EXPECT_EQ(intersections(mesh), each);
}

/// One vertex far off must not put all faces into a few cells.
TEST(SelfIntersections, AFarVertexTakesHardlyMoreTime) {
  Mesh mesh = sheet(400, 0);
  const auto seconds = [&] {
    const std::clock_t start = std::clock();
    EXPECT_TRUE(intersections(mesh).empty());
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double without = seconds();
  for (const float far_mm : {1e5F, 1e7F, 1e9F}) {
    mesh.positions[200 * 401 + 200].z() = far_mm;
    EXPECT_LT(seconds(), 0.3 + 5 * without) << far_mm;
  }
}

TEST(SelfIntersections, CoordinatesNearTheLargestEnd) {
  Mesh mesh = sheet(20, 0);
  add_face(mesh, {-3e38F, 2, 3e38F}, {3e38F, 2, 3e38F}, {0, 2, -3e38F});
  add_face(mesh, {3e38F, 3e38F, 3e38F}, {3e38F, 3e38F, 3e38F}, {3e38F, 3e38F, 3e38F});
  const auto huge = static_cast<std::uint32_t>(mesh.faces.size() - 2);
  for (const auto& [a, b] : intersections(mesh)) {
    EXPECT_LT(a, huge);
    EXPECT_EQ(b, huge);
  }
}

TEST(SelfIntersections, BrokenMeshes) {
  EXPECT_TRUE(intersections({}).empty());
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 9}, {0, 0, 0}};
  EXPECT_TRUE(intersections(mesh).empty());
}

}  // namespace
}  // namespace dubsar
