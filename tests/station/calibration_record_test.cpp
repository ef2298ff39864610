// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The calibrations that a session keeps.
#include "station/calibration_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;

TEST(CalibrationRecord, NoCalibrationTakesThePlaceOfAnother) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  for (const char* json : {R"({"a":1})", R"({"a":2})", R"({"a":1})", R"({"a":2})", R"({"a":3})"}) {
    ASSERT_TRUE(keep_calibration(*store, {"rig.json", json, "2026-01-02T03:04:05Z"}));
  }
  const std::string first = "calibration 2026-01-02T03:04:05Z";
  ASSERT_THAT(*store->document_names(), ElementsAre(first, first + " 2", first + " 3"));
  EXPECT_EQ(**store->load_document(first), R"({"a":1})");
  EXPECT_EQ(**store->load_document(first + " 2"), R"({"a":2})");
  EXPECT_EQ(**store->load_document(first + " 3"), R"({"a":3})");
}

}  // namespace
}  // namespace dubsar
