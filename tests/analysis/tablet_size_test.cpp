// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/tablet_size.h"

#include <gtest/gtest.h>

#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

TEST(TabletSize, IsThatOfTheVerticesInUse) {
  Mesh mesh = shapes::box({3, 2, 6}, 2);
  mesh.positions.emplace_back(1000, 0, 0);
  EXPECT_NEAR(size_across_mm(mesh), 14, 1e-4);
  EXPECT_EQ(size_across_mm({}), 0);
}

TEST(TabletSize, TellsTheUnitWhereTheNumbersCannotBeMillimetres) {
  EXPECT_EQ(likelier_unit(60, 1), std::nullopt);
  EXPECT_EQ(likelier_unit(0.06, 1), "m");
  EXPECT_EQ(likelier_unit(60000, 1), "um");
  EXPECT_EQ(likelier_unit(29834, 1000), "mm");  // a glTF file whose numbers are no metres
  EXPECT_EQ(likelier_unit(1e9, 1), std::nullopt);
  EXPECT_EQ(likelier_unit(0, 1), std::nullopt);
}

}  // namespace
}  // namespace dubsar
