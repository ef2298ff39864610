// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/outlook.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dubsar {
namespace {

/// A square sheet of z = height(x, y), 0.2 mm between vertices.
template <class Height>
Mesh sheet(int n, const Height& height) {
  Mesh mesh;
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const float x = 0.2F * static_cast<float>(i);
      const float y = 0.2F * static_cast<float>(j);
      mesh.positions.emplace_back(x, y, height(x, y));
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(MeanOutlook, OfASlopeIsItsNormal) {
  const Mesh mesh = sheet(30, [](float x, float) { return 0.5F * x; });
  const Eigen::Vector3f normal = Eigen::Vector3f(-0.5F, 0, 1).normalized();
  for (const Eigen::Vector3f& o : mean_outlook(mesh, 1.0)) {
    EXPECT_GT(o.dot(normal), 1 - 1e-5F);
  }
}

TEST(MeanOutlook, LooksPastAFurrow) {
  // Its walls look sideways by 45 degrees, the surface at large upwards.
  const Mesh mesh = sheet(60, [](float x, float) { return -std::max(0.0F, 0.4F - std::abs(x - 6.0F)); });
  for (const Eigen::Vector3f& o : mean_outlook(mesh, 1.0)) {
    EXPECT_GT(o.z(), 0.95F);
  }
}

TEST(MeanOutlook, IsZeroWhereThereIsNothing) {
  Mesh mesh = sheet(4, [](float, float) { return 0.0F; });
  mesh.positions.emplace_back(100, 0, 0);
  mesh.positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  mesh.faces.push_back({0, 1, 4000000});
  const auto outlook = mean_outlook(mesh, 1.0);
  ASSERT_EQ(outlook.size(), mesh.positions.size());
  EXPECT_EQ(outlook[25], Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(outlook[26], Eigen::Vector3f(0, 0, 0));
  EXPECT_GT(outlook[0].z(), 0.99F);
}

}  // namespace
}  // namespace dubsar
