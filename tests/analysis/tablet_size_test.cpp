// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/tablet_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(TabletSize, IsThatOfTheVerticesInUse) {
  Mesh mesh = shapes::box({3, 2, 6}, 2);
  mesh.positions.emplace_back(1000, 0, 0);
  EXPECT_NEAR(size_across_mm(mesh), 14, 1e-4);
  EXPECT_TRUE(size_mm(mesh).isApprox(Eigen::Vector3d(6, 4, 12))) << size_mm(mesh);
  EXPECT_EQ(size_across_mm({}), 0);
}

TEST(TabletSize, TellsTheUnitWhereTheNumbersCannotBeMillimetres) {
  EXPECT_THAT(likelier_units(60, 1), IsEmpty());
  EXPECT_THAT(likelier_units(0.06, 1), ElementsAre("m"));
  EXPECT_THAT(likelier_units(60000, 1), ElementsAre("um"));
  EXPECT_THAT(likelier_units(4, 1), ElementsAre("cm", "in"));
  EXPECT_THAT(likelier_units(29834, 1000), ElementsAre("mm", "cm", "in"));  // a glTF file of no metres
  EXPECT_THAT(likelier_units(1e9, 1), IsEmpty());
  EXPECT_THAT(likelier_units(0, 1), IsEmpty());
}

TEST(TabletSize, OfUnitsThatFilesAreInOneAloneIsLikely) {
  EXPECT_EQ(likely_unit(60, 1), std::nullopt) << "it is inscribed as it is";
  EXPECT_EQ(likely_unit(0.06, 1), "m");
  EXPECT_EQ(likely_unit(60000, 1), "um");
  EXPECT_EQ(likely_unit(29834, 1000), "mm");
  EXPECT_EQ(likely_unit(4, 1), std::nullopt) << "centimetres or inches: who knows";
  EXPECT_EQ(likely_unit(0.884, 1), std::nullopt);
  EXPECT_TRUE(is_inscribed_size(6) && is_inscribed_size(800));
  EXPECT_FALSE(is_inscribed_size(5.9) || is_inscribed_size(801));
}

TEST(TabletSize, FarFromTheOriginPlacesAreCoarse) {
  Mesh mesh = shapes::box({3, 2, 6}, 2);
  EXPECT_LT(coarsest_place_mm(mesh), 1e-6);
  for (Eigen::Vector3f& p : mesh.positions) {
    p.y() -= 300000;
  }
  EXPECT_EQ(coarsest_place_mm(mesh), 0.03125);
  mesh.faces.clear();
  EXPECT_EQ(coarsest_place_mm(mesh), 0);
}

TEST(TabletSize, WhatCannotBeMeasuredIsRefusedByItsNumbers) {
  const Mesh mesh = shapes::box({3, 2, 6}, 2);
  EXPECT_TRUE(check_measurable(mesh, "m.ply"));
  Mesh far = mesh;
  Mesh large = mesh;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    far.positions[v].y() -= 300000;
    large.positions[v] *= 1e5F;
  }
  const Status refused = check_measurable(far, "m.ply");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "m.ply");
  EXPECT_THAT(refused.error().what, HasSubstr("places are good to 0.031 mm only"));
  ASSERT_FALSE(check_measurable(large, ""));
  EXPECT_THAT(check_measurable(large, "").error().what, HasSubstr("1.4e+06 mm across"));
}

}  // namespace
}  // namespace dubsar
