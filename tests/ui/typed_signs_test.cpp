// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/typed_signs.h"

#include <gtest/gtest.h>

#include "core/utf8.h"

namespace dubsar::ui {
namespace {

TEST(TypedSigns, CuneiformIsStoodInForByWhatFitsIntoSixteenBits) {
  const std::string line = "BM 𒀭 15285, متحف, äöü, 가 (U+AC00), 𝄞";
  const std::string stand_ins = stand_ins_of(line);
  EXPECT_NE(stand_ins, line);
  for (std::string_view left = stand_ins; !left.empty();) {
    const CodePoint c = first_code_point(left);
    ASSERT_GT(c.bytes, 0U);
    EXPECT_LT(c.value, 0x10000U);
    left.remove_prefix(c.bytes);
  }
  EXPECT_EQ(signs_of(stand_ins), line);
  EXPECT_TRUE(can_be_typed_into(line));
}

TEST(TypedSigns, WhatFitsIsItself) {
  const std::string line = "VAT 12345, Tontafel, متحف بغداد";
  EXPECT_EQ(stand_ins_of(line), line);
  EXPECT_EQ(signs_of(line), line);
}

TEST(TypedSigns, ASignHasOneStandInHoweverItComes) {
  const std::uint32_t an = stand_in_of(0x1202D);
  EXPECT_EQ(stand_in_of(0x1202D), an);
  EXPECT_NE(stand_in_of(0x12000), an);
  EXPECT_EQ(first_code_point(stand_ins_of("𒀭")).value, an);
}

TEST(TypedSigns, BytesThatAreNoTextAreSeenAsThat) {
  EXPECT_TRUE(can_be_typed_into("BM \xFF 1"));
  EXPECT_EQ(stand_ins_of("BM \xFF 1"), "BM \xEF\xBF\xBD 1");
}

// Last: what it fills stays full.
TEST(TypedSignsFull, AreLeftAsTheyAreWhenThereAreTooMany) {
  for (std::uint32_t sign = 0x20000; sign < 0x20000 + 11172; ++sign) {
    (void)stand_in_of(sign);
  }
  EXPECT_EQ(stand_in_of(0x2FFFF), 0xFFFDU);
  EXPECT_FALSE(can_be_typed_into("\xF0\xAF\xBF\xBF"));
  EXPECT_TRUE(can_be_typed_into("BM 1"));
}

}  // namespace
}  // namespace dubsar::ui
