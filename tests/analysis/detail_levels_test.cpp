// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/detail_levels.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "analysis/place_order.h"
#include "core/mesh.h"

namespace dubsar {
namespace {

/// A ring of 2 n² faces, closed, as thick as it is wide.
Mesh ring(std::uint32_t n) {
  Mesh mesh;
  const auto angle = [&](std::uint32_t k) {
    return 2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(n);
  };
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const float out = 30 + 15 * std::cos(angle(j));
      mesh.positions.emplace_back(out * std::cos(angle(i)), out * std::sin(angle(i)),
                                  15 * std::sin(angle(j)));
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return (y % n) * n + x % n; };
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      mesh.faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Eigen::AlignedBox3f box_of(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& p : mesh.positions) {
    box.extend(p);
  }
  return box;
}

std::vector<DetailLevel> levels_of(const Mesh& mesh, std::size_t fewest) {
  return detail_levels(mesh.positions, mesh.faces, box_of(mesh), fewest);
}

double area_of(const Mesh& mesh, const DetailLevel& level) {
  Mesh part;
  part.positions = mesh.positions;
  part.faces = level.faces;
  return surface_area_mm2(part);
}

TEST(DetailLevels, EachHasFourTimesTheFacesOfTheLastNearTheSurface) {
  const Mesh mesh = ring(400);  // 320 thousand faces
  const std::vector<DetailLevel> levels = levels_of(mesh, 5000);
  ASSERT_EQ(levels.size(), 3U);
  const double area = surface_area_mm2(mesh);
  std::size_t before = 1250;
  for (const DetailLevel& level : levels) {
    EXPECT_GT(level.faces.size(), 2 * before);
    EXPECT_LT(level.faces.size(), 8 * before);
    before = level.faces.size();
    EXPECT_NEAR(area_of(mesh, level), area, 0.04 * area);
    ASSERT_EQ(level.from.size(), level.faces.size());
    EXPECT_TRUE(std::ranges::is_sorted(level.from));
    for (std::size_t f = 0; f < level.faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {  // no further than a cell's diagonal from where it was
        const float moved =
            (mesh.positions[level.faces[f][k]] - mesh.positions[mesh.faces[level.from[f]][k]]).norm();
        ASSERT_LE(moved, 1.733F * level.cell_mm);
      }
    }
  }
}

TEST(DetailLevels, AClosedSurfaceStaysClosed) {
  const Mesh mesh = ring(200);
  for (const DetailLevel& level : levels_of(mesh, 2000)) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // there and back again
    for (const auto& f : level.faces) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = f[k];
        const std::uint32_t b = f[(k + 1) % 3];
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
    EXPECT_TRUE(std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; }));
  }
}

TEST(DetailLevels, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = ring(250);
  const std::vector<DetailLevel> many = levels_of(mesh, 2000);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<DetailLevel> alone = levels_of(mesh, 2000);
  ASSERT_EQ(many.size(), alone.size());
  for (std::size_t k = 0; k < many.size(); ++k) {
    EXPECT_EQ(many[k].faces, alone[k].faces);
    EXPECT_EQ(many[k].from, alone[k].from);
  }
}

TEST(DetailLevels, FewFacesStrayPointsAndNoAreaAreNoTrouble) {
  EXPECT_TRUE(levels_of(ring(20), 1000).empty()) << "few already";
  EXPECT_TRUE(levels_of(Mesh{}, 1000).empty());
  Mesh strayed = ring(200);
  strayed.positions.emplace_back(3e9F, -1e9F, 4e9F);
  strayed.faces.push_back({0, 1, static_cast<std::uint32_t>(strayed.positions.size() - 1)});
  for (const DetailLevel& level : levels_of(strayed, 1000)) {
    EXPECT_LE(level.faces.size(), strayed.faces.size());
  }
  Mesh flat = ring(100);
  std::ranges::fill(flat.positions, Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(levels_of(flat, 1000).empty());
}

TEST(PlaceOrder, EveryFaceOnceAndNeighboursTogether) {
  const Mesh mesh = ring(300);
  const std::vector<std::uint32_t> order = order_by_place(mesh.positions, mesh.faces, box_of(mesh));
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), mesh.faces.size());
  const auto spread_of = [&](const auto& face_at) {
    constexpr std::size_t kRun = 1000;
    float sum = 0;
    for (std::size_t first = 0; first + kRun <= order.size(); first += kRun) {
      Eigen::AlignedBox3f box;
      for (std::size_t k = first; k < first + kRun; ++k) {
        box.extend(mesh.positions[mesh.faces[face_at(k)][0]]);
      }
      sum += box.diagonal().norm();
    }
    return sum;
  };
  EXPECT_LT(spread_of([&](std::size_t k) { return order[k]; }),
            0.4F * spread_of([](std::size_t k) { return k; }));
}

}  // namespace
}  // namespace dubsar
