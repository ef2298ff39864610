// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_record.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(TabletRecord, ACdliNumberIsAPAndSixDigits) {
  EXPECT_TRUE(check_cdli(""));
  EXPECT_TRUE(check_cdli("P123456"));
  for (const char* bad : {"P12345", "P1234567", "p123456", "123456", "P12345x", "P 12345"}) {
    EXPECT_FALSE(check_cdli(bad)) << bad;
  }
  TabletRecord record{"VAT \"1\"", "P000001", "Berlin", "A. Reader", "CC BY 4.0", "line\nbreak"};
  const auto again = parse_tablet_record(tablet_record_to_json(record), "test");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(*again, record);
}

}  // namespace
}  // namespace dubsar
