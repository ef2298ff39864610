// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The peer that stitches as seed 001, 4 says (bench/support/link_merge.h), in the situation of its figure 9.
#include "bench/support/link_merge.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "triangulation/mesh_check.h"

namespace dubsar::bench {
namespace {

using Eigen::Vector3f;

/// A flat grid of side × side samples 1 mm apart, seen from +z. Every cell's diagonal is 00-11, or 01-10.
LinkMesh flat_grid(std::uint32_t side, const Vector3f& origin, bool antidiagonal) {
  LinkMesh out;
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t col = 0; col < side; ++col) {
      out.positions.emplace_back(origin + Vector3f(static_cast<float>(col), static_cast<float>(row), 0));
      const std::uint32_t i = row * side + col, right = i + 1, below = i + side, across = below + 1;
      if (row + 1 < side && col + 1 < side && antidiagonal) {
        out.faces.push_back({i, right, below});
        out.faces.push_back({right, across, below});
      } else if (row + 1 < side && col + 1 < side) {
        out.faces.push_back({i, right, across});
        out.faces.push_back({i, across, below});
      }
    }
  }
  out.normals.assign(out.positions.size(), Vector3f::UnitZ());
  out.to_scanner = out.normals;
  out.reliability.assign(out.positions.size(), 1.0F);
  out.weight = out.reliability;
  return out;
}

bool has_edge(const LinkMesh& mesh, const Vector3f& a, const Vector3f& b) {
  return std::ranges::any_of(mesh.faces, [&](const auto& f) {
    const auto has = [&](const Vector3f& p) {
      return std::ranges::any_of(f, [&](std::uint32_t v) { return (mesh.positions[v] - p).norm() < 1e-4F; });
    };
    return has(a) && has(b);
  });
}

MeshReport check(const LinkMesh& mesh) {
  Mesh plain;
  plain.positions = mesh.positions;
  plain.faces = mesh.faces;
  return check_mesh(plain);
}

/// No sample is within reach of the place of a neighbour.
const LinkMergeOptions kOptions{.reach = {2.5F, 0.9F}};

constexpr std::uint32_t kSide = 5;
constexpr std::uint32_t kMiddle = 12;  ///< (2, 2)

/// M and M', a quarter of the spacing beside it, whose diagonals run the other way. Every P is the more
/// reliable but those of M' that are named.
LinkMerge merged_grids(const std::vector<std::uint32_t>& more_reliable_in_second, LinkMesh* second) {
  const LinkMesh m = flat_grid(kSide, {0, 0, 0}, false);
  *second = flat_grid(kSide, {0.25F, 0, 0}, true);
  second->reliability.assign(second->positions.size(), 0.5F);
  for (const std::uint32_t v : more_reliable_in_second) {
    second->reliability[v] = 2.0F;
  }
  second->weight = second->reliability;
  return merge_links(m, *second, kOptions);
}

TEST(LinkMerge, TheMoreReliableMeshStaysWhereNothingElseIs) {
  LinkMesh second;
  const LinkMerge merge = merged_grids({}, &second);
  EXPECT_EQ(merge.pairs, 25U);
  EXPECT_EQ(merge.conforming, 40U);  // the sides of the cells: the diagonals run across each other
  EXPECT_EQ(merge.edges.weak, 0U);
  EXPECT_EQ(merge.mesh.positions.size(), 25U);
  EXPECT_EQ(merge.mesh.faces.size(), 32U);
  EXPECT_TRUE(has_edge(merge.mesh, {2, 2, 0}, {3, 3, 0}));
  EXPECT_FALSE(has_edge(merge.mesh, {3, 2, 0}, {2, 3, 0}));
  EXPECT_TRUE(check(merge.mesh).is_manifold());
}

TEST(LinkMerge, AWeakEdgeThatCrossesOneThatIsNotIsDeleted) {
  // F' alone is the more reliable of its pair: its edges of M' are weak, and so are those of M to it.
  LinkMesh second;
  const LinkMerge merge = merged_grids({kMiddle}, &second);
  const Vector3f f = second.positions[kMiddle];
  // Two diagonals of M end at it, two of M', each in a cell of its own. Those of M' cross diagonals of M.
  EXPECT_EQ(merge.edges.weak, 4U);
  EXPECT_EQ(merge.edges.crossed, 2U);
  EXPECT_EQ(merge.edges.outdone, 0U);
  EXPECT_TRUE(has_edge(merge.mesh, f, {3, 3, 0}));
  EXPECT_TRUE(has_edge(merge.mesh, f, {1, 1, 0}));
  EXPECT_FALSE(has_edge(merge.mesh, f, {3, 1, 0}));
  EXPECT_FALSE(has_edge(merge.mesh, f, {1, 3, 0}));
  EXPECT_EQ(merge.mesh.faces.size(), 32U);
  EXPECT_TRUE(check(merge.mesh).is_manifold());
}

TEST(LinkMerge, OfTwoWeakEdgesTheOneWithTheLowerChangeOfGradientStays) {
  // F' and its neighbour below are of M', P and what lies below it of M: in the cell between them the
  // diagonals of both meshes are weak.
  for (const bool bent : {false, true}) {
    const LinkMesh m = flat_grid(kSide, {0, 0, 0}, false);
    LinkMesh second = flat_grid(kSide, {0.25F, 0, 0}, true);
    second.reliability.assign(second.positions.size(), 0.5F);
    second.reliability[kMiddle] = second.reliability[kMiddle + kSide] = 2.0F;
    second.weight = second.reliability;
    // Of the diagonals (2, 2)-(3, 3) and (3, 2)-(2, 3) of the cell, one end of either is of M'.
    const std::uint32_t bent_vertex = bent ? kMiddle : kMiddle + kSide;
    second.normals[bent_vertex] = Vector3f(0.6F, 0, 0.8F);
    const LinkMerge merge = merge_links(m, second, kOptions);
    EXPECT_GE(merge.edges.outdone, 1U);
    EXPECT_EQ(has_edge(merge.mesh, second.positions[kMiddle], {3, 3, 0}), !bent);
    EXPECT_EQ(has_edge(merge.mesh, {3, 2, 0}, second.positions[kMiddle + kSide]), bent);
    EXPECT_EQ(merge.mesh.faces.size(), 32U);
    EXPECT_TRUE(check(merge.mesh).is_manifold());
  }
}

TEST(LinkMerge, PositionsAreAveragesByReliabilityAlongTheRay) {
  const LinkMesh m = flat_grid(kSide, {0, 0, 0}, false);
  LinkMesh second = flat_grid(kSide, {0.25F, 0.25F, 0.4F}, true);
  second.reliability.assign(second.positions.size(), 1.0F / 3);
  second.weight = second.reliability;
  const LinkMerge merge = merge_links(m, second, kOptions);
  const auto& p = merge.mesh.positions;
  EXPECT_TRUE(
      std::ranges::any_of(p, [](const Vector3f& q) { return (q - Vector3f(2, 2, 0.1F)).norm() < 1e-4F; }));
}

TEST(LinkMerge, WhatHasNoPairIsKept) {
  const LinkMesh m = flat_grid(kSide, {0, 0, 0}, false);
  const LinkMesh apart = flat_grid(kSide, {50, 0, 0}, true);
  const LinkMerge merge = merge_links(m, apart, kOptions);
  EXPECT_EQ(merge.pairs, 0U);
  EXPECT_EQ(merge.mesh.faces.size(), 64U);
  EXPECT_EQ(check(merge.mesh).components, 2U);

  // Half beside it: one mesh, none of it twice.
  const LinkMesh beside = flat_grid(kSide, {3, 0, 0}, false);
  const LinkMerge joined = merge_links(m, beside, kOptions);
  EXPECT_EQ(joined.pairs, 10U);
  EXPECT_EQ(joined.mesh.faces.size(), 2U * 4U * 7U);
  EXPECT_EQ(check(joined.mesh).boundary_loops, 1U);
}

}  // namespace
}  // namespace dubsar::bench
