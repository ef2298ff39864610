// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a window shows of a session that was left: the disk as it is, and how old the calibration is now.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/rig_scan.h"
#include "acquisition/session_store.h"
#include "formats/checklist_json.h"
#include "station/calibration_age.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

constexpr const char* kLongAgo = "2020-01-01T00:00:00Z";
constexpr const char* kOfARig = "rig.json, made 2020-01-01T00:00:00Z at 20.5 °C";

TEST(LiveMoment, DiskAndAgeOfTheCalibrationAreThoseOfNow) {
  const test::TemporaryFolder folder;
  double free_gib = 0;
  Checklist then;
  then.disk_free_gib = 0.125;
  then.calibration = kOfARig;
  then.calibration_age_days = 3.5;
  const std::string kept = checklist_to_json(then);
  {
    SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
    ASSERT_TRUE(store.add_grid(test::bumpy_scan(0)));
    ASSERT_TRUE(store.save_document("checklist", kept));
    free_gib = store.disk_free_gib();
  }
  test::Followed followed("replay:" + folder.path().string(), folder.path() / "s");
  followed.session.read();
  ASSERT_TRUE(followed.wait_for_rest());
  const LiveState state = followed.session.state();
  ASSERT_TRUE(state.checklist);
  // Other programs write to it too.
  EXPECT_NEAR(state.checklist->disk_free_gib, free_gib, 0.05 * free_gib);
  ASSERT_GT(free_gib, 0.2);
  EXPECT_NEAR(state.checklist->calibration_age_days.value_or(0), days_since(kLongAgo).value(), 0.1);
  const SessionStore store = SessionStore::open(folder.path() / "s", SessionStore::Access::kReadOnly).value();
  EXPECT_EQ(store.load_document("checklist").value(), kept) << "the pages say how it was then";
}

TEST(CalibrationAge, IsCountedFromItsDateElseFromTheLastScan) {
  const double since = days_since(kLongAgo).value();
  Checklist list;
  EXPECT_FALSE(calibration_age_now(list, kLongAgo));
  list.calibration_age_days = 3.5;
  EXPECT_EQ(calibration_age_now(list, ""), 3.5);
  EXPECT_NEAR(calibration_age_now(list, kLongAgo).value_or(0), 3.5 + since, 0.1);
  list.calibration = "by its maker";
  EXPECT_NEAR(calibration_age_now(list, kLongAgo).value_or(0), 3.5 + since, 0.1);
  list.calibration = kOfARig;
  EXPECT_NEAR(calibration_age_now(list, "2021-01-01T00:00:00Z").value_or(0), since, 0.1);
  // A clock that was wrong tells nothing.
  list.calibration = "rig.json, made 2999-01-01T00:00:00Z";
  EXPECT_EQ(calibration_age_now(list, ""), 3.5);
}

}  // namespace
}  // namespace dubsar
