// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/feature_mat.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "formats/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::TemporaryFolder;

TEST(FeatureMat, IsOneLineAVertex) {
  const TemporaryFolder folder;
  const std::vector<float> value{0.5F, -0.25F, 1e-7F, 0.333333333F, std::numeric_limits<float>::quiet_NaN(),
                                 1};
  ASSERT_TRUE(write_feature_mat(folder.path() / "a.mat", value, 2, "first\nsecond"));
  const auto text = read_whole_file(folder.path() / "a.mat");
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, "# first\n# second\n0 0.5 -0.25\n1 1e-07 0.333333\n2 0 1\n");
}

TEST(FeatureMat, ManyVerticesStayInOrder) {
  const TemporaryFolder folder;
  constexpr std::size_t kCount = 300000;
  const std::vector<float> value(kCount, 2.0F);
  ASSERT_TRUE(write_feature_mat(folder.path() / "a.mat", value, 1, ""));
  const auto text = read_whole_file(folder.path() / "a.mat");
  ASSERT_TRUE(text);
  std::string expected;
  for (std::size_t i = 0; i < kCount; ++i) {
    expected += std::to_string(i) + " 2\n";
  }
  EXPECT_TRUE(*text == expected);
}

TEST(FeatureMat, HalfAVertexIsRefused) {
  EXPECT_FALSE(write_feature_mat("/nowhere/a.mat", std::vector<float>{1, 2, 3}, 2, ""));
}

}  // namespace
}  // namespace dubsar
