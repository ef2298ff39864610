// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/tablet.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <map>

#include "core/mesh_query.h"
#include "core/units.h"

namespace dubsar::sim {
namespace {

TabletOptions small_tablet() {
  TabletOptions options;
  options.size_mm = {24, 20, 11};
  options.spacing_mm = 0.2;
  options.line_height_mm = 4;
  return options;
}

SimTablet make(const TabletOptions& options) {
  JobContext job;
  Result<SimTablet> tablet = make_tablet(options, job);
  EXPECT_TRUE(tablet.has_value()) << tablet.error().line();
  return std::move(*tablet);
}

TEST(Tablet, IsWatertightAndOrientedOutwards) {
  const SimTablet tablet = make(small_tablet());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0;
  for (const auto& f : tablet.mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{f[k], f[(k + 1) % 3]}];
    }
    volume += tablet.mesh.positions[f[0]].cast<double>().dot(tablet.mesh.positions[f[1]].cast<double>().cross(
                  tablet.mesh.positions[f[2]].cast<double>())) /
              6.0;
  }
  for (const auto& [edge, uses] : edges) {
    ASSERT_EQ(uses, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
  const auto v = static_cast<long>(tablet.mesh.positions.size());
  EXPECT_EQ(v - static_cast<long>(edges.size() / 2) + static_cast<long>(tablet.mesh.faces.size()), 2);
  EXPECT_GT(volume, 0.5 * 24 * 20 * 11);
  EXPECT_LT(volume, 24 * 20 * 11);
}

}  // namespace
}  // namespace dubsar::sim
