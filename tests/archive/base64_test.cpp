// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/base64.h"

#include <gtest/gtest.h>

#include <string_view>

namespace dubsar {
namespace {

std::string encoded(std::string_view text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// RFC 4648, section 10.
TEST(Base64, MatchesTheVectorsOfItsStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesEveryByte) {
  const std::array<std::uint8_t, 3> bytes = {0xFB, 0xEF, 0xFF};
  EXPECT_EQ(base64(bytes), "++//");
}

TEST(Base64, ReadsBackWhatItWrote) {
  std::string bytes;
  for (int length = 0; length < 40; ++length) {
    const std::vector<std::uint8_t> in(bytes.begin(), bytes.end());
    EXPECT_EQ(from_base64(base64(in)), bytes) << length;
    bytes.push_back(static_cast<char>(37 * length + 200));
  }
  EXPECT_FALSE(from_base64("abc"));
  EXPECT_FALSE(from_base64("ab=c"));
  EXPECT_FALSE(from_base64("ab c"));
}

}  // namespace
}  // namespace dubsar
