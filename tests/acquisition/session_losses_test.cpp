// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Records that damage took away: kept aside, named as long as they are lacking, brought back from a copy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "acquisition/session_store.h"
#include "formats/sha2.h"
#include "formats/sign_off_json.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/acquisition/spoil.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::SessionDamageTest;
using test::small_grid;
using test::spoil;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;
constexpr auto kReadWrite = SessionStore::Access::kReadWrite;

class SessionLossesTest : public SessionDamageTest {
 protected:
  void SetUp() override {
    SessionDamageTest::SetUp();
    fs::copy(folder_, copy_, fs::copy_options::recursive);
  }
  void spoil_both(const std::string& text) const { test::spoil_both(folder_, text); }
  void remove_both() const {
    fs::remove(database_);
    fs::remove(backup_);
  }
  [[nodiscard]] std::vector<std::string> lost() {
    std::vector<std::string> out;
    const VerifyReport report = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
    for (const Error& error : report.lost) {
      out.push_back(error.what);
    }
    return out;
  }
  static void expect_events_in_order(const SessionStore& store, std::size_t at_least) {
    const auto events = store.events().value();
    EXPECT_GE(events.size(), at_least);
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_EQ(events[i].number, static_cast<std::int64_t>(i) + 1) << events[i].kind;
    }
  }

  const fs::path database_ = folder_ / "session.sqlite";
  const fs::path backup_ = folder_ / "session.backup.sqlite";
  const fs::path copy_ = temporary_.path() / "copy";
};

TEST_F(SessionLossesTest, ADamagedBackupIsKeptBesideTheOneThatTakesItsPlace) {
  fs::remove(database_);
  spoil(backup_, "bench");
  const std::string damaged = test::text_of_file(backup_);
  const std::string sums = test::text_of_file(folder_ / "session.sums");
  {
    const SessionStore store = SessionStore::open(folder_).value();
    EXPECT_THAT(store.opening().notes,
                Contains("kept the damaged backup as session.backup.sqlite.damaged-1"));
    EXPECT_THAT(store.opening().notes,
                Contains("kept the damaged list of checksums as session.sums.damaged-1"));
  }
  EXPECT_NE(test::text_of_file(backup_), damaged);
  EXPECT_EQ(test::text_of_file(folder_ / "session.backup.sqlite.damaged-1"), damaged);
  EXPECT_EQ(test::text_of_file(folder_ / "session.sums.damaged-1"), sums);
  EXPECT_THAT(lost(), Contains("documents row rig is lost"));
}

TEST_F(SessionLossesTest, ADamagedBackupOfAWholeDatabaseIsKeptToo) {
  spoil(backup_, "bench");
  const std::string damaged = test::text_of_file(backup_);
  { expect_content(SessionStore::open(folder_).value()); }
  EXPECT_EQ(test::text_of_file(folder_ / "session.backup.sqlite.damaged-1"), damaged);
  EXPECT_THAT(lost(), IsEmpty());
  { ASSERT_TRUE(SessionStore::open(folder_)); }
  EXPECT_FALSE(fs::exists(folder_ / "session.backup.sqlite.damaged-2")) << "the one in its place is whole";
}

TEST_F(SessionLossesTest, GridsThatNoTableListsProveThatALogIsMissing) {
  const fs::path killed = temporary_.path() / "killed";
  leave_with_log(killed);  // one scan
  fs::copy(killed, copy_ / "whole", fs::copy_options::recursive);
  fs::remove(killed / "session.sqlite-wal");
  fs::remove(killed / "session.sqlite-shm");
  const auto lost_of = [&](const fs::path& folder) {
    return SessionStore::open(folder, kReadOnly).value().verify(job_).value().lost;
  };
  EXPECT_THAT(lost_of(killed), IsEmpty()) << "a kill between a grid and its row leaves as much";
  fs::copy(folder_ / "grids/002.grid", killed / "grids/001.grid");
  ASSERT_EQ(lost_of(killed).size(), 1U);
  EXPECT_THAT(lost_of(killed)[0].line(),
              HasSubstr("session.sqlite-wal: records are lost that nothing names: the log is missing, or its "
                        "end, for 2 whole grids are in no table"));
  EXPECT_FALSE(SessionStore::open(killed, kReadWrite, SessionStore::OnDamage::kRefuse));
  {
    const SessionStore store = SessionStore::open(killed).value();
    ASSERT_EQ(store.opening().damage.size(), 1U);
    EXPECT_THAT(store.opening().damage[0].what, HasSubstr("the log is missing"));
    EXPECT_THAT(store.scans().value().at(1).remark, HasSubstr("it may have been taken out"));
    EXPECT_THAT(store.load_grid(1).value().z, small_grid(2).z);
  }
  EXPECT_THAT(SessionStore::open(killed)->opening().damage, IsEmpty()) << "it is told once";
  ASSERT_EQ(lost_of(killed).size(), 1U) << "and stands in the record";
  EXPECT_THAT(lost_of(killed)[0].what, HasSubstr("or their log was missing"));
  const SessionStore mended = SessionStore::open_with_copy(killed, copy_ / "whole").value();
  EXPECT_EQ(mended.load_document("document 11").value(), "{}");
}

TEST_F(SessionLossesTest, AMissingLogIsToldAndBroughtBackFromACopyAtOnce) {
  const fs::path killed = temporary_.path() / "killed";
  const int status = test::in_child([&]() -> int {
    Result<SessionStore> store = SessionStore::open_or_create(killed);
    bool good = store.has_value();
    for (int i = 0; i < 3; ++i) {
      good = good && store->add_grid(small_grid(i));
    }
    good = good && store->drop_scan(1, "blurred");
    ::_exit(good ? 0 : 1);
  });
  ASSERT_EQ(status, 0);
  fs::copy(killed, copy_ / "whole", fs::copy_options::recursive);
  fs::remove(killed / "session.sqlite-wal");
  fs::remove(killed / "session.sqlite-shm");
  const SessionStore mended = SessionStore::open_with_copy(killed, copy_ / "whole").value();
  EXPECT_EQ(mended.scans().value().at(1).note, "blurred");
  EXPECT_THAT(mended.verify(job_)->lost, IsEmpty());
}

TEST_F(SessionLossesTest, TheSameDamagedBytesLieAsideOnce) {
  fs::resize_file(database_, fs::file_size(database_) / 2);
  const VerifyReport found = SessionStore::open(folder_, kReadOnly)->verify(job_).value();
  EXPECT_THAT(SessionStore::keep_damaged_records(folder_, found).value(),
              ElementsAre("session.sqlite.damaged-1"));
  { expect_content(SessionStore::open(folder_).value()); }
  EXPECT_FALSE(fs::exists(folder_ / "session.sqlite.damaged-2"));
  EXPECT_THAT(lost(), IsEmpty()) << "the backup had everything";
}

TEST_F(SessionLossesTest, WhatNothingBringsBackIsNamedFromThenOn) {
  spoil_both("bench");
  spoil_both("blurred");  // scan 1's row, and the event that took it out
  EXPECT_THAT(lost(), testing::IsSupersetOf({"documents row rig is lost", "events row 5 is lost"}));
  {
    const SessionStore store = SessionStore::open(folder_).value();
    std::string told;
    for (const Error& damage : store.opening().damage) {
      told += damage.line() + "\n";
    }
    EXPECT_THAT(told, HasSubstr("documents row rig is lost; bring it back from a copy"));
    EXPECT_THAT(store.scans().value()[1].remark, HasSubstr("it may have been taken out"));
  }
  const SessionStore again = SessionStore::open(folder_, kReadOnly).value();
  EXPECT_THAT(again.opening().damage, IsEmpty());
  EXPECT_TRUE(again.verify(job_)->ok()) << "what is stored now is whole";
  EXPECT_THAT(lost(),
              ElementsAre("documents row rig is lost", "events row 5 is lost", "scans row 1 is lost"));
  { ASSERT_TRUE(SessionStore::open(folder_)->save_document("rig", "{}")); }
  EXPECT_THAT(lost(), ElementsAre("events row 5 is lost", "scans row 1 is lost")) << "the rig was told anew";
}

TEST_F(SessionLossesTest, AMissingEventIsLostWhoeverLostIt) {
  // An earlier version said nothing of it.
  spoil_both("made 2");
  spoil_both("made 3");
  { ASSERT_TRUE(SessionStore::open(folder_)); }
  EXPECT_THAT(lost(), testing::IsSupersetOf({"events row 3 is lost", "events row 4 is lost"}));
}

TEST_F(SessionLossesTest, AScanWhoseRowIsLostStaysOutAsItsRecordSays) {
  spoil_both("grids/001.grid");
  const SessionStore store = SessionStore::open(folder_).value();
  expect_content(store);
  EXPECT_EQ(store.scans().value()[1].note, "blurred");
  EXPECT_THAT(store.opening().notes,
              Contains(HasSubstr("001.grid, whose row was lost: taken out, as its record says")));
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty()) << "all of it was known";
}

TEST_F(SessionLossesTest, ResultsOfOneTimeComeFromTheBackup) {
  {
    SessionStore store = SessionStore::open(folder_).value();
    ScanPose first, second;
    first.id = 2;
    second.id = 3;
    second.reason = "laid by hand";
    ASSERT_TRUE(store.save_poses({first, second}));
  }
  spoil(database_, "laid by hand");
  const SessionStore store = SessionStore::open(folder_).value();
  ASSERT_EQ(store.poses()->size(), 2U);
  EXPECT_EQ(store.poses()->back().reason, "laid by hand");
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty());
}

TEST_F(SessionLossesTest, ACopyBringsBackTheRowsThatAreLost) {
  spoil_both("bench");
  spoil_both("blurred");
  for (const char* when : {"at once", "again"}) {
    SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
    EXPECT_THAT(store.opening().brought_back,
                when == std::string("again")
                    ? testing::Matcher<std::vector<std::string>>(IsEmpty())
                    : ElementsAre("scans row 1", "documents row rig", "events row 5"));
    EXPECT_FALSE(store.opening().no_use_of_copy) << when;
    expect_content(store);
    EXPECT_EQ(store.scans().value()[1].note, "blurred");
    EXPECT_EQ(store.events().value()[4].kind, "scan dropped");
    expect_events_in_order(store, 6);
  }
  EXPECT_THAT(lost(), IsEmpty());
}

TEST_F(SessionLossesTest, ACopyBringsBackAllRecordsWhereNoneWasLeft) {
  remove_both();
  {
    const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
    expect_content(store);
    EXPECT_EQ(store.poses()->size(), 1U);
    expect_events_in_order(store, 6);
  }
  EXPECT_THAT(lost(), IsEmpty());
}

TEST_F(SessionLossesTest, WhatWasRecordedSinceTheLossFollowsWhatComesBack) {
  remove_both();
  {
    SessionStore store = SessionStore::open(folder_).value();
    EXPECT_FALSE(store.scans().value()[1].dropped) << "nothing tells";
    EXPECT_THAT(store.scans().value()[1].remark, HasSubstr("it may have been taken out"));
    ASSERT_TRUE(store.drop_scan(3, "since then"));
    ASSERT_EQ(store.add_grid(small_grid(4)).value(), 4);
  }
  EXPECT_THAT(lost(), Contains(HasSubstr("records are lost that nothing names")));
  {
    const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
    const auto scans = store.scans().value();
    ASSERT_EQ(scans.size(), 5U);
    EXPECT_EQ(scans[1].note, "blurred");
    EXPECT_EQ(scans[3].note, "since then");
    EXPECT_EQ(store.load_document("rig").value(), "{\"name\":\"bench\"}");
    expect_events_in_order(store, 12);
    EXPECT_EQ(store.events().value()[4].kind, "scan dropped");
  }
  EXPECT_THAT(lost(), IsEmpty());
}

TEST_F(SessionLossesTest, WhatIsNoCopyOfTheSessionGivesNoRecord) {
  const fs::path other = temporary_.path() / "other";
  {
    SessionStore store = SessionStore::open_or_create(other).value();
    ASSERT_TRUE(store.add_grid(small_grid(7)));
    ASSERT_TRUE(store.save_document("rig", "{\"name\":\"another\"}"));
  }
  spoil_both("bench");
  const SessionStore store = SessionStore::open_with_copy(folder_, other).value();
  ASSERT_TRUE(store.opening().no_use_of_copy);
  EXPECT_THAT(store.opening().no_use_of_copy->line(),
              HasSubstr("nothing shows that it is a copy of this session"));
  EXPECT_FALSE(store.load_document("rig").value());
  EXPECT_THAT(store.opening().brought_back, IsEmpty());
}

TEST_F(SessionLossesTest, ACopyThatWentItsOwnWayGivesNothingOfThat) {
  { ASSERT_TRUE(SessionStore::open(copy_)->drop_scan(2, "in the copy alone")); }
  { ASSERT_TRUE(SessionStore::open(folder_)->append_event("own way")); }
  spoil_both("bench");
  const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
  EXPECT_THAT(store.opening().brought_back, ElementsAre("documents row rig"));
  EXPECT_FALSE(store.scans().value()[2].dropped);
  EXPECT_EQ(store.events().value()[5].kind, "own way");
}

TEST_F(SessionLossesTest, ARowThatTheSessionHasStaysWhereItsGridIsDamaged) {
  remove_both();
  { ASSERT_TRUE(SessionStore::open(folder_)); }  // takes the grids in
  test::flip_byte(folder_ / "grids/001.grid", 1234);
  const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
  expect_content(store, {1});
  EXPECT_EQ(store.scans().value()[1].note, "blurred");
}

TEST_F(SessionLossesTest, ARowComesBackThoughItsGridIsDamaged) {
  remove_both();
  test::flip_byte(folder_ / "grids/001.grid", 1234);
  fs::remove(folder_ / "grids/002.grid");
  const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
  expect_content(store, {1, 2});
  EXPECT_EQ(store.scans().value()[1].note, "blurred");
}

TEST_F(SessionLossesTest, DamagedRecordsAreRefusedBeforeAnythingIsWritten) {
  spoil_both("bench");
  const std::string database = test::text_of_file(database_);
  const std::string backup = test::text_of_file(backup_);
  const auto refused = SessionStore::open(folder_, kReadWrite, SessionStore::OnDamage::kRefuse);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(refused.error().line(), HasSubstr("documents row rig"));
  EXPECT_THAT(refused.error().line(), HasSubstr("dubsar verify --repair"));
  EXPECT_EQ(test::text_of_file(database_), database);
  EXPECT_EQ(test::text_of_file(backup_), backup);
  EXPECT_FALSE(fs::exists(folder_ / "session.sqlite.damaged-1"));
  // A damaged grid is none of the records, and what was lost before keeps nobody from going on.
  { ASSERT_TRUE(SessionStore::open(folder_)); }
  test::flip_byte(folder_ / "grids/002.grid", 1234);
  EXPECT_TRUE(SessionStore::open(folder_, kReadWrite, SessionStore::OnDamage::kRefuse));
}

TEST_F(SessionLossesTest, ALostSignOffTakesNoNumberOfAnother) {
  const auto sign = [&](const char* name) {
    SignOff made;
    made.number = 1;
    made.name = name;
    made.when = "2026-01-02T03:04:05Z";
    made.program = "Dubsar 0.1.0";
    made.digest = sha256_hex("");
    return SessionStore::open(folder_)->append_event("signed", recorded_sign_off_to_json({made, ""}));
  };
  ASSERT_TRUE(sign("A. Reader"));
  ASSERT_TRUE(SessionStore::open(folder_)->append_event("looked at"));  // which both have
  fs::remove_all(copy_);
  fs::copy(folder_, copy_, fs::copy_options::recursive);
  spoil_both("A. Reader");
  ASSERT_TRUE(sign("B. Reader"));
  const SessionStore store = SessionStore::open_with_copy(folder_, copy_).value();
  ASSERT_TRUE(store.opening().no_use_of_copy);
  EXPECT_THAT(store.opening().no_use_of_copy->line(), HasSubstr("sign-off 1 was lost"));
  EXPECT_THAT(store.opening().brought_back, IsEmpty());
}

}  // namespace
}  // namespace dubsar
