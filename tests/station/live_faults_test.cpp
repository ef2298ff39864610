// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a window is told of a session whose records are lost or whose scans are damaged: on every opening,
// whatever was written in between.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "core/red_map.h"
#include "formats/red_map_json.h"
#include "tests/acquisition/spoil.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;
using ::testing::Contains;
using ::testing::IsEmpty;

class LiveFaults : public ::testing::Test {
 protected:
  /// Three scans, the second taken out; signed.
  void SetUp() override {
    Result<SessionStore> store = SessionStore::open_or_create(at_);
    ASSERT_TRUE(store);
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(store->add_grid(test::bumpy_scan(k)));
    }
    ASSERT_TRUE(store->drop_scan(1, "a hand in view"));
    RedMap map;
    map.conclusive = true;
    ASSERT_TRUE(store->save_document("red_map", red_map_to_json(map)));
    ASSERT_TRUE(store->save_document("checklist", "{}"));
    SignOff wanted;
    wanted.name = "A. Reader";
    wanted.conclusive = true;
    JobContext job;
    ASSERT_TRUE(sign_session(*store, wanted, job));
  }
  [[nodiscard]] LiveState opened() const {
    Followed followed(kSmallTablet, at_);
    followed.session.read();
    EXPECT_TRUE(followed.wait_for_rest());
    return followed.session.state();
  }
  void write_something() const {
    Result<SessionStore> store = SessionStore::open(at_);
    ASSERT_TRUE(store);
    ASSERT_TRUE(store->save_document("a note", "{}"));
  }

  test::TemporaryFolder folder_;
  const std::filesystem::path at_ = folder_.path() / "s";
};

TEST_F(LiveFaults, AWholeSessionHasNone) {
  const LiveState state = opened();
  EXPECT_THAT(state.lost_records, IsEmpty());
  EXPECT_TRUE(state.void_signed_by.empty());
  EXPECT_EQ(state.signed_by, "A. Reader");
}

TEST_F(LiveFaults, ALostSignatureIsToldOnEveryOpening) {
  test::spoil_both(at_, "A. Reader");
  const auto is_told = Contains("what was done (a signature, or that a scan was taken out)");
  EXPECT_THAT(opened().lost_records, is_told);
  write_something();  // the tables are rebuilt
  EXPECT_THAT(opened().lost_records, is_told);
  EXPECT_THAT(opened().lost_records, is_told);
}

TEST_F(LiveFaults, TablesThatAreGoneAreToldThoughNothingNamesWhatStoodInThem) {
  std::filesystem::remove(at_ / "session.sqlite");
  std::filesystem::remove(at_ / "session.backup.sqlite");
  write_something();
  const LiveState state = opened();
  EXPECT_THAT(state.lost_records, Contains("records that nothing names"));
  ASSERT_EQ(state.scans.size(), 3U);
  EXPECT_TRUE(state.scans[1].record_lost) << "it was taken out, and stands";
  EXPECT_FALSE(state.scans[1].dropped);
}

TEST_F(LiveFaults, DamagedScansSayWhyAndWhoseSignatureNoLongerHolds) {
  std::filesystem::remove(at_ / "grids" / "000.grid");
  test::flip_byte(at_ / "grids" / "002.grid", 200, 1);
  const LiveState state = opened();
  ASSERT_EQ(state.scans.size(), 3U);
  EXPECT_TRUE(state.scans[0].damaged);
  EXPECT_EQ(state.scans[0].fault, "missing");
  EXPECT_TRUE(state.scans[2].damaged);
  EXPECT_EQ(state.scans[2].fault, "not the bytes that were stored");
  EXPECT_TRUE(state.scans[1].fault.empty());
  EXPECT_FALSE(state.signed_off);
  EXPECT_EQ(state.void_signed_by, "A. Reader");
}

}  // namespace
}  // namespace dubsar
