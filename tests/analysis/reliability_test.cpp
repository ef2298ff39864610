// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/reliability.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

std::vector<float> reliability_of(const Mesh& mesh, int n) {
  return vertex_reliability(mesh, make_vertex_graph(mesh), n);
}

TEST(Reliability, AClosedMeshIsWhollyReliable) {
  EXPECT_THAT(reliability_of(shapes::sphere(10, 3), 2), testing::Each(1.0F));
}

/// Seed 000, 3.1 by hand: a strip of a large sheet seen from its left border. The faces along the open edge
/// are selected; n = 2 dilations take in two more columns of faces, three erosions give them back one by
/// one from the inside, r = 2/3, 1/3, 0.
TEST(Reliability, FallsInStepsTowardsAnOpenBorder) {
  constexpr int kCells = 40;
  const Mesh mesh = shapes::sheet(20, kCells, [](float, float) { return 0.0F; });
  const std::vector<float> r = reliability_of(mesh, 2);
  const auto at = [&](int x) { return r[20 * (kCells + 1) + static_cast<std::size_t>(x)]; };
  EXPECT_FLOAT_EQ(at(0), 0);
  EXPECT_FLOAT_EQ(at(1), 0);
  EXPECT_FLOAT_EQ(at(2), 1.0F / 3);
  EXPECT_FLOAT_EQ(at(3), 2.0F / 3);
  EXPECT_FLOAT_EQ(at(4), 1);
  EXPECT_FLOAT_EQ(at(20), 1);
}

TEST(Reliability, TwoFansAtOneVertexAreNotTrusted) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_THAT(reliability_of(mesh, 0), testing::Each(0.0F));
}

TEST(Reliability, AFlippedFaceAndAThirdFaceAtAnEdgeAreFaults) {
  const Mesh sphere = shapes::sphere(10, 4);
  Mesh flipped = sphere;
  std::swap(flipped.faces[700][0], flipped.faces[700][1]);
  EXPECT_FLOAT_EQ(reliability_of(flipped, 1)[flipped.faces[700][0]], 0);
  Mesh fin = sphere;
  fin.positions.emplace_back(20, 20, 20);
  fin.faces.push_back(
      {fin.faces[700][0], fin.faces[700][1], static_cast<std::uint32_t>(fin.positions.size() - 1)});
  const std::vector<float> r = reliability_of(fin, 1);
  EXPECT_FLOAT_EQ(r[fin.faces[700][0]], 0);
  EXPECT_EQ(std::count(r.begin(), r.end(), 1.0F) > 900, true);
}

TEST(Reliability, AHubOfManyFacesIsJudgedAsQuicklyAndAlike) {
  // A cone of so many faces that comparing each with each would take minutes.
  constexpr std::uint32_t kMany = 200000;
  Mesh cone;
  cone.positions = {{0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 0; i < kMany; ++i) {
    const float angle = 6.2831853F * static_cast<float>(i) / kMany;
    cone.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0F);
    cone.faces.push_back({0, 2 + i, 2 + (i + 1) % kMany});
    cone.faces.push_back({1, 2 + (i + 1) % kMany, 2 + i});
  }
  EXPECT_THAT(reliability_of(cone, 1), testing::Each(1.0F));
  cone.faces.push_back(cone.faces[5000]);  // once more: it takes no part
  EXPECT_THAT(reliability_of(cone, 1), testing::Each(1.0F));
  cone.faces.erase(cone.faces.begin() + 5000);
  cone.faces.pop_back();
  EXPECT_FLOAT_EQ(reliability_of(cone, 1)[0], 0);
}

TEST(Reliability, TheMeshsOwnTakesPart) {
  Mesh mesh = shapes::sphere(10, 3);
  mesh.reliability.assign(mesh.positions.size(), 0.5F);
  mesh.positions.emplace_back(1, 2, 3);  // without a face
  mesh.reliability.push_back(1);
  const std::vector<float> r = reliability_of(mesh, 2);
  EXPECT_FLOAT_EQ(r[7], 0.5F);
  EXPECT_FLOAT_EQ(r.back(), 0);
}

TEST(Reliability, OfTheMeshsOwnWhatIsNoShareOfOneIsBroughtIntoIt) {
  Mesh mesh = shapes::sphere(10, 3);
  mesh.reliability.assign(mesh.positions.size(), 0.5F);
  mesh.reliability[1] = std::numeric_limits<float>::quiet_NaN();
  mesh.reliability[2] = -3;
  mesh.reliability[3] = 85;  // a percentage
  const std::vector<float> r = reliability_of(mesh, 2);
  EXPECT_FLOAT_EQ(r[1], 0);
  EXPECT_FLOAT_EQ(r[2], 0);
  EXPECT_FLOAT_EQ(r[3], 1);
  EXPECT_FLOAT_EQ(r[4], 0.5F);
}

}  // namespace
}  // namespace dubsar
