// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/self_intersections.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/chunk_loop.h"
#include "core/mesh.h"
#include "core/random.h"
#include "tests/triangulation/support/comparisons_of.h"
#include "triangulation/face_cut.h"

namespace dubsar {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs intersections(const Mesh& mesh) {
  return self_intersections(mesh.positions, mesh.faces);
}

/// Each pair of faces, looked at.
Pairs each_pair(const Mesh& mesh) {
  Pairs each;
  for (std::uint32_t a = 0; a < mesh.faces.size(); ++a) {
    const FacePlane plane(mesh.positions, mesh.faces[a]);
    for (std::uint32_t b = a + 1; b < mesh.faces.size(); ++b) {
      if (faces_cut(mesh.positions, mesh.faces[a], plane, mesh.faces[b])) {
        each.emplace_back(a, b);
      }
    }
  }
  return each;
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
  const Pairs each = each_pair(mesh);
  EXPECT_GT(each.size(), 60U);
  EXPECT_EQ(intersections(mesh), each);
}

/// Flat faces, smaller than the steps of floats along x where they lie, and longer ones through them.
TEST(SelfIntersections, OfFacesSmallerThanFloatsCanTellNoneIsMissed) {
  Random random(11);
  Mesh mesh;
  for (const float far_mm : {1e6F, -3e7F}) {
    const float step_mm = std::abs(std::nextafterf(far_mm, 2 * far_mm) - far_mm);
    const auto drawn = [&](double size) {
      return Eigen::Vector3f(far_mm + step_mm * static_cast<float>(std::floor(random.uniform(0, 20))),
                             static_cast<float>(random.uniform(-size, size)),
                             static_cast<float>(random.uniform(-size, size)));
    };
    for (int k = 0; k < 600; ++k) {
      std::array<Eigen::Vector3f, 3> corner{drawn(0.01), drawn(0.01), drawn(0.01)};
      if (k % 10 != 0) {
        corner[1].x() = corner[2].x() = corner[0].x();
      }
      add_face(mesh, corner[0], corner[1], corner[2]);
    }
  }
  const Pairs each = each_pair(mesh);
  EXPECT_GT(each.size(), 1000U);
  EXPECT_EQ(intersections(mesh), each);
}

TEST(SelfIntersections, IsWorkInStepWithTheFaces) {
  const std::size_t of_small = test::comparisons_of(sheet(100, 0));
  EXPECT_GT(of_small, std::size_t{2} * 100 * 100);
  EXPECT_LT(test::comparisons_of(sheet(200, 0)), 5 * of_small);
}

/// One vertex far off must not put all faces into a few cells.
TEST(SelfIntersections, AFarVertexIsHardlyMoreWork) {
  Mesh mesh = sheet(100, 0);
  const std::size_t without = test::comparisons_of(mesh);
  for (const float far_mm : {1e5F, 1e7F, 1e9F, 1e38F}) {
    mesh.positions[50 * 101 + 50].z() = far_mm;
    EXPECT_LT(test::comparisons_of(mesh), 3 * without) << far_mm;  // in cells for the least
  }
}

Mesh two_sheets(int n, const Eigen::Vector3f& apart) {
  Mesh mesh = sheet(n, 0);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Eigen::Vector3f& p : sheet(n, 0).positions) {
    mesh.positions.emplace_back(p + apart);
  }
  for (const auto& f : sheet(n, 0).faces) {
    mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  }
  return mesh;
}

/// As far from each other, in sizes of their faces, as two finds in one file whose poses are those of a site.
TEST(SelfIntersections, PartsFarApartAreNoMoreWork) {
  const std::size_t near = test::comparisons_of(two_sheets(100, {300, 0, 0}));
  for (const Eigen::Vector3f& apart :
       {Eigen::Vector3f(3e6F, 0, 0), Eigen::Vector3f(-8e6F, 8e6F, 8e6F), Eigen::Vector3f(0, 0, 1e30F)}) {
    Mesh mesh = two_sheets(100, apart);
    EXPECT_LT(test::comparisons_of(mesh), 1.2 * near) << apart.transpose();
    // Of sizes that differ, too.
    add_face(mesh, {0, 0, -1}, apart + Eigen::Vector3f(0, 0, -1), {0, 1e7F, -1});
    EXPECT_LT(test::comparisons_of(mesh), 3 * near) << apart.transpose();
  }
}

/// So many that the finest cells are made for them.
TEST(SelfIntersections, TinyFacesMakeTheOthersNoMoreWork) {
  Mesh mesh = sheet(100, 0);
  const std::size_t without = test::comparisons_of(mesh);
  for (const float size_mm : {1e-9F, 1e-15F, 1e-37F}) {
    Mesh with = mesh;
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector3f at(0, 0, -1.0F - static_cast<float>(k));
      add_face(with, at, at + Eigen::Vector3f(size_mm, 0, 0), at + Eigen::Vector3f(0, size_mm, 0));
    }
    EXPECT_LT(test::comparisons_of(with), 3 * without) << size_mm;
  }
}

TEST(SelfIntersections, CoordinatesNearTheLargestEnd) {
  Mesh mesh = sheet(20, 0);
  add_face(mesh, {-3e38F, 2.5F, 3e38F}, {3e38F, 2.5F, 3e38F}, {0, 2.5F, -3e38F});
  add_face(mesh, {3e38F, 3e38F, 3e38F}, {3e38F, 3e38F, 3e38F}, {3e38F, 3e38F, 3e38F});
  const auto huge = static_cast<std::uint32_t>(mesh.faces.size() - 2);
  const Pairs found = intersections(mesh);
  EXPECT_EQ(found.size(), 40U);  // a row of the sheet
  EXPECT_EQ(found, each_pair(mesh));
  for (const auto& [a, b] : found) {
    EXPECT_EQ(b, huge);
  }
}

/// All in one place: each is held against each other, unless it is stopped.
TEST(SelfIntersections, AreStopped) {
  constexpr std::size_t kFaces = 4000;
  Mesh mesh;
  for (std::size_t k = 0; k < kFaces; ++k) {
    add_face(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  }
  JobContext job;
  std::atomic<std::size_t> comparisons{0};
  EXPECT_TRUE(self_intersections(mesh.positions, mesh.faces, {}, job, [&](std::size_t more) {
                comparisons += more;
                job.cancel();
              }).empty());
  EXPECT_GT(comparisons, 0U);
  EXPECT_LE(comparisons, 2 * kFaces * chunks_at_once());
}

TEST(SelfIntersections, OfACancelledJobNoneAreLookedFor) {
  Mesh mesh;
  add_face(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_face(mesh, {1, 1, -1}, {1, 1, 1}, {9, 9, 1});
  JobContext job;
  job.cancel();
  EXPECT_TRUE(self_intersections(mesh.positions, mesh.faces, {}, job).empty());
  const std::vector<std::uint32_t> part = {1, 2};
  EXPECT_TRUE(self_intersections(mesh.positions, mesh.faces, part, job).empty());
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
