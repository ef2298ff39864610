// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What several threads do at once comes out as if one had done it.

#include "core/parallel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "core/disjoint_sets.h"
#include "core/mesh.h"
#include "core/parallel_erase.h"
#include "core/parallel_sort.h"
#include "tests/support/raster_mesh.h"

namespace dubsar {
namespace {

TEST(Parallel, SetsUnitedByAllThreadsAtOnceHaveTheirLeastMemberAsRoot) {
  constexpr std::uint32_t kCount = 200000;
  std::mt19937 random(7);
  std::uniform_int_distribution<std::uint32_t> any(0, kCount - 1);
  std::vector<std::array<std::uint32_t, 2>> links(kCount);
  for (auto& link : links) {
    link = {any(random), any(random)};
  }
  DisjointSets sets(kCount);
  parallel_for_each_index(
      links.size(), [&](std::size_t i) { sets.unite(links[i][0], links[i][1]); }, 64);
  // The same by hand: labels go over the links until none changes.
  std::vector<std::uint32_t> least(kCount);
  std::iota(least.begin(), least.end(), 0U);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links) {
      const std::uint32_t low = std::min(least[a], least[b]);
      changed = changed || least[a] != low || least[b] != low;
      least[a] = least[b] = low;
    }
  }
  for (std::uint32_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(sets.root(i), least[i]);
  }
}

TEST(Parallel, WhatOneChunkFoundIsNotLostToItsNeighbours) {
  constexpr std::size_t kCount = 20000;
  for (std::size_t here = 0; here < kCount; here += 97) {
    const bool found = parallel_reduce_ordered(
        kCount, 1, false, [&](std::size_t begin, std::size_t) { return begin == here; },
        [](bool& total, bool part) { total = total || part; });
    ASSERT_TRUE(found) << here;
  }
}

TEST(Parallel, ErasingKeepsTheOrderOfWhatStays) {
  std::vector<int> items(100000);
  std::iota(items.begin(), items.end(), 0);
  std::vector<int> expected = items;
  erase_where(items, [](int i) { return i < 0; });
  EXPECT_EQ(items, expected);
  erase_where(items, [](int i) { return i % 7 == 3 || i > 90000; });
  std::erase_if(expected, [](int i) { return i % 7 == 3 || i > 90000; });
  EXPECT_EQ(items, expected);
  erase_where(items, [](int) { return true; });
  EXPECT_THAT(items, testing::IsEmpty());
}

TEST(Parallel, RangesCoverEverythingOnce) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{3} << 18U}) {
    std::vector<int> seen(count, 0);
    parallel_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        ++seen[i];
      }
    });
    EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(count));
  }
}

TEST(Parallel, NormalsOfALargeMeshAreThoseOfOneThread) {
  constexpr std::uint32_t kSide = 800;  // more vertices than one range takes
  Mesh mesh;
  for (std::uint32_t y = 0; y <= kSide; ++y) {
    for (std::uint32_t x = 0; x <= kSide; ++x) {
      mesh.positions.emplace_back(
          0.1F * static_cast<float>(x), 0.1F * static_cast<float>(y),
          std::sin(0.3F * static_cast<float>(x)) * std::cos(0.2F * static_cast<float>(y)));
    }
  }
  test::add_raster_faces(mesh, 0, kSide);
  std::vector<Eigen::Vector3f> expected(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f n =
        (mesh.positions[f[1]] - mesh.positions[f[0]]).cross(mesh.positions[f[2]] - mesh.positions[f[0]]);
    for (const std::uint32_t v : f) {
      expected[v] += n;
    }
  }
  const std::vector<Eigen::Vector3f> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    ASSERT_LT((normals[v] - expected[v].normalized()).norm(), 1e-6F) << v;
  }
}

TEST(Parallel, ASortOfACancelledJobEndsAtOnceAndLosesNothing) {
  constexpr std::uint32_t kCount = 200000;
  std::vector<std::uint32_t> numbers(kCount);
  std::iota(numbers.rbegin(), numbers.rend(), 0U);
  std::vector<std::uint32_t> stopped = numbers;
  JobContext job;
  parallel_sort(numbers.begin(), numbers.end(), std::less<>{}, job);
  EXPECT_TRUE(std::ranges::is_sorted(numbers));
#ifndef DUBSAR_THREAD_SANITIZER
  std::atomic<std::size_t> comparisons{0};
  const auto counted = [&](std::uint32_t a, std::uint32_t b) {
    if (++comparisons == kCount) {  // well into it: there are seventeen times as many
      job.cancel();
    }
    return a < b;
  };
  std::shuffle(stopped.begin(), stopped.end(), std::mt19937(3));
  parallel_sort(stopped.begin(), stopped.end(), counted, job);
  EXPECT_LT(comparisons, 3 * kCount);
  EXPECT_FALSE(std::ranges::is_sorted(stopped));
#endif
  job.cancel();
  parallel_sort(stopped.begin(), stopped.end(), std::less<>{}, job);
  std::ranges::sort(stopped);
  EXPECT_EQ(stopped, numbers);
}

}  // namespace
}  // namespace dubsar
