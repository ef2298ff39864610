// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "formats/atomic_file.h"
#include "tests/acquisition/session_support.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::small_grid;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SessionStoreTest : public testing::Test {
 protected:
  SessionStore open() {
    Result<SessionStore> store = SessionStore::open_or_create(folder_);
    EXPECT_TRUE(store) << store.error().line();
    return std::move(*store);
  }
  test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "deep" / "session";
};

TEST_F(SessionStoreTest, MakesTheFoldersAndGivesBackWhatWasStored) {
  {
    SessionStore store = open();
    EXPECT_TRUE(store.opening().created);
    EXPECT_EQ(store.add_grid(small_grid(3)).value(), 0);
    EXPECT_EQ(store.add_grid(small_grid(4)).value(), 1);
    EXPECT_TRUE(fs::is_directory(store.mesh_folder()));
    EXPECT_TRUE(fs::is_directory(store.analysis_folder()));
    EXPECT_TRUE(fs::is_directory(store.export_folder()));
    EXPECT_GT(store.disk_free_gib(), 0);
  }
  const SessionStore store = open();
  EXPECT_FALSE(store.opening().created);
  EXPECT_THAT(store.opening().damage, IsEmpty());
  const auto scans = store.scans().value();
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[1].file, "grids/001.grid");
  EXPECT_EQ(scans[1].source, "made 4");
  EXPECT_EQ(scans[1].samples, static_cast<std::int64_t>(small_grid(4).valid_count()));
  const RangeGrid back = store.load_grid(1).value();
  const RangeGrid put = small_grid(4);
  EXPECT_EQ(back.x, put.x);
  EXPECT_EQ(back.valid, put.valid);
  EXPECT_EQ(back.spacing_mm, put.spacing_mm);
  EXPECT_EQ(back.source, put.source);
  EXPECT_EQ(store.load_grid(2).error().kind, ErrorKind::kUsage);
}

TEST_F(SessionStoreTest, PosesComeBackBitForBit) {
  ScanPose pose;
  pose.id = 5;
  pose.file = "a \"b\".ply";
  pose.model_from_scanner =
      RigidTransform::from_twist({0.1, -0.2, 1.0 / 3.0}, {1e-9, 12345.678901234567, -0.1});
  pose.status = PoseStatus::kUnsure;
  pose.rms_mm = 0.1 + 0.2;
  pose.sigma_mm = std::numeric_limits<double>::quiet_NaN();
  pose.overlap = 0.75;
  pose.reason = "two places fit equally";
  pose.warning = "its lengths are off";
  pose.locked = true;
  pose.covariance.emplace();
  for (int i = 0; i < 36; ++i) {
    (*pose.covariance)(i / 6, i % 6) = 1.0 / (i + 3);
  }
  ScanPose other;
  other.id = 2;
  other.status = PoseStatus::kRegistered;
  {
    SessionStore store = open();
    ASSERT_TRUE(store.save_poses({ScanPose{}, other, pose}));
    ASSERT_TRUE(store.save_poses({pose, other}));
  }
  const auto poses = open().poses().value();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].id, 2);
  EXPECT_EQ(poses[0].status, PoseStatus::kRegistered);
  EXPECT_FALSE(poses[0].covariance);
  const ScanPose& back = poses[1];
  EXPECT_EQ(back.file, pose.file);
  EXPECT_EQ(back.model_from_scanner.row_major(), pose.model_from_scanner.row_major());
  EXPECT_EQ(back.status, PoseStatus::kUnsure);
  EXPECT_EQ(back.rms_mm, pose.rms_mm);
  EXPECT_TRUE(std::isnan(back.sigma_mm));
  EXPECT_EQ(back.reason, pose.reason);
  EXPECT_EQ(back.warning, pose.warning);
  EXPECT_TRUE(back.locked);
  ASSERT_TRUE(back.covariance);
  EXPECT_EQ(*back.covariance, *pose.covariance);
}

TEST_F(SessionStoreTest, FlagsDocumentsAndEventsComeBack) {
  SampleFlags flags(10000, kPotentiallySparse);
  flags[17] = kSparse | kCleared;
  {
    SessionStore store = open();
    ASSERT_TRUE(store.save_flags(3, flags));
    ASSERT_TRUE(store.save_flags(4, {}));
    ASSERT_TRUE(store.save_document("red map", "{\"conclusive\":false}"));
    ASSERT_TRUE(store.save_document("red map", "{\"conclusive\":true}"));
    ASSERT_TRUE(store.append_event("operator turned the tablet", "{\"deg\":40}"));
  }
  SessionStore store = open();
  EXPECT_EQ(store.load_flags(3).value(), flags);
  EXPECT_EQ(store.load_flags(4).value(), SampleFlags{});
  EXPECT_FALSE(store.load_flags(5).value());
  EXPECT_EQ(store.load_document("red map").value(), "{\"conclusive\":true}");
  EXPECT_FALSE(store.load_document("pins").value());
  EXPECT_THAT(store.document_names().value(), ElementsAre("red map"));
  ASSERT_TRUE(store.append_event("second"));
  const auto events = store.events().value();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].number, 1);
  EXPECT_EQ(events[0].kind, "operator turned the tablet");
  EXPECT_EQ(events[0].json, "{\"deg\":40}");
  EXPECT_EQ(events[1].number, 2);
  EXPECT_GE(events[1].time_ns, events[0].time_ns);
}

TEST_F(SessionStoreTest, WhatTheDeviceRemarkedOnAScanComesBack) {
  const std::string said = "read as seen along 0 0 -1, \"by its outline\"; a spacing of 0.25 mm, nicht 2,5";
  {
    SessionStore store = open();
    ASSERT_TRUE(store.add_grid(small_grid(0)));
    ASSERT_TRUE(store.add_grid(small_grid(1), said));
    ASSERT_TRUE(store.append_event("scan stored", "not JSON"));
    ASSERT_TRUE(store.append_event("scan stored", R"({"id":"0","remark":"of no scan"})"));
    ASSERT_TRUE(store.append_event("note", R"({"id":0,"remark":"of no device"})"));
    EXPECT_EQ(store.scans().value()[1].remark, said);
  }
  for (const auto access : {SessionStore::Access::kReadOnly, SessionStore::Access::kReadWrite}) {
    const Result<SessionStore> store = SessionStore::open(folder_, access);
    ASSERT_TRUE(store);
    const auto scans = store->scans().value();
    EXPECT_EQ(scans[0].remark, "");
    EXPECT_EQ(scans[1].remark, said);
  }
}

TEST_F(SessionStoreTest, DroppingAndUndoingDeleteNothing) {
  {
    SessionStore store = open();
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(store.add_grid(small_grid(i)));
    }
    ASSERT_TRUE(store.drop_scan(1, "a thumb in the way"));
    ASSERT_TRUE(store.drop_scan(1, "something else"));
    EXPECT_EQ(store.undo_last_scan().value(), 2);
    EXPECT_EQ(store.undo_last_scan().value(), 0);
    EXPECT_EQ(store.undo_last_scan().value(), std::nullopt);
    ASSERT_TRUE(store.restore_scan(0));
    ASSERT_TRUE(store.restore_scan(0));
    EXPECT_EQ(store.drop_scan(8).error().kind, ErrorKind::kUsage);
  }
  SessionStore store = open();
  const auto scans = store.scans().value();
  EXPECT_FALSE(scans[0].dropped);
  EXPECT_TRUE(scans[1].dropped);
  EXPECT_EQ(scans[1].note, "a thumb in the way");
  EXPECT_TRUE(scans[2].dropped);
  EXPECT_TRUE(store.load_grid(2));
  EXPECT_EQ(store.add_grid(small_grid(7)).value(), 3) << "numbers are never used twice";
  std::vector<std::string> kinds;
  const std::vector<SessionEvent> events = store.events().value();
  for (const SessionEvent& event : events) {
    kinds.push_back(event.kind);
  }
  EXPECT_THAT(kinds, ElementsAre("scan stored", "scan stored", "scan stored", "scan dropped", "scan dropped",
                                 "scan dropped", "scan restored", "scan stored"));
}

TEST_F(SessionStoreTest, ASecondWriterIsToldAndReadersComeAnyTime) {
  SessionStore store = open();
  ASSERT_TRUE(store.add_grid(small_grid(1)));
  const auto second = SessionStore::open_or_create(folder_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kStorage) << "it goes away: to be tried again";
  EXPECT_THAT(second.error().line(), HasSubstr("process " + std::to_string(::getpid())));

  Result<SessionStore> reader = SessionStore::open(folder_, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ(reader->scans().value().size(), 1U);
  EXPECT_TRUE(reader->load_grid(0));
  EXPECT_FALSE(reader->add_grid(small_grid(2)));
  EXPECT_FALSE(reader->save_document("a", "{}"));
  ASSERT_TRUE(store.add_grid(small_grid(2)));
  EXPECT_EQ(reader->scans().value().size(), 1U) << "a reader sees the moment of its opening";
  EXPECT_EQ(SessionStore::open(folder_, SessionStore::Access::kReadOnly)->scans().value().size(), 2U);
}

TEST_F(SessionStoreTest, RefusesFoldersThatAreNoSession) {
  fs::create_directories(folder_);
  EXPECT_FALSE(SessionStore::is_session(folder_));
  EXPECT_EQ(SessionStore::open(folder_).error().kind, ErrorKind::kUsage);
  std::ofstream(folder_ / "letter.txt") << "Dear sister";
  const auto store = SessionStore::open_or_create(folder_);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().kind, ErrorKind::kUsage);
  EXPECT_FALSE(fs::exists(folder_ / "session.sqlite"));
  EXPECT_FALSE(SessionStore::open_or_create(folder_ / "letter.txt"));
}

TEST_F(SessionStoreTest, AFolderThatCannotBeLookedIntoIsRefusedInWords) {
  fs::create_directories(folder_);
  fs::create_symlink("session.sqlite",
                     folder_ / "session.sqlite");  // to itself: as good as one without rights
  const auto store = SessionStore::open_or_create(folder_);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().kind, ErrorKind::kStorage);
  EXPECT_THAT(store.error().line(), HasSubstr("session: cannot read the folder"));
}

TEST_F(SessionStoreTest, AGridWithWrongArraysIsRefused) {
  SessionStore store = open();
  RangeGrid grid = small_grid(1);
  grid.z.pop_back();
  EXPECT_EQ(store.add_grid(grid).error().kind, ErrorKind::kInternal);
  EXPECT_THAT(store.scans().value(), IsEmpty());
}

TEST_F(SessionStoreTest, VerifyCoversGridsDatabaseAndRecordedFiles) {
  SessionStore store = open();
  ASSERT_TRUE(store.add_grid(small_grid(1)));
  std::ofstream(store.mesh_folder() / "model.ply") << "ply, more or less";
  std::ofstream(store.mesh_folder() / "draft.ply") << "not recorded";
  ASSERT_TRUE(store.record_file("mesh/model.ply"));
  EXPECT_EQ(store.record_file("../elsewhere").error().kind, ErrorKind::kUsage);
  JobContext job;
  const VerifyReport whole = store.verify(job).value();
  EXPECT_TRUE(whole.ok());
  EXPECT_THAT(whole.whole, ElementsAre("session.sqlite", "grids/000.grid", "mesh/model.ply"));
  EXPECT_THAT(whole.unrecorded, ElementsAre("mesh/draft.ply"));
  std::ofstream(store.mesh_folder() / "model.ply") << "ply, more or LESS";
  const VerifyReport changed = store.verify(job).value();
  ASSERT_EQ(changed.damaged.size(), 1U);
  EXPECT_EQ(changed.damaged[0].where, "mesh/model.ply");
  job.cancel();
  EXPECT_EQ(store.verify(job).error().kind, ErrorKind::kCancelled);
}

TEST_F(SessionStoreTest, AFileKeepsItsChecksumUntilANewOneTakesItsPlace) {
  SessionStore store = open();
  const fs::path model = store.mesh_folder() / "model.ply";
  const auto put = [](const char* text) {
    return [text](const fs::path& file) { return write_file_atomically(file, std::string_view(text)); };
  };
  JobContext job;
  const auto whole = [&] { return store.verify(job).value().whole; };
  ASSERT_TRUE(store.replace_file("mesh/model.ply", put("old")));
  EXPECT_EQ(read_whole_file(model).value(), "old");
  const Status failed = store.replace_file("mesh/model.ply", [&](const fs::path& file) -> Status {
    EXPECT_EQ(file.extension(), ".ply");
    EXPECT_TRUE(put("half of the ne")(file));
    EXPECT_THAT(whole(), ElementsAre("session.sqlite", "mesh/model.ply")) << "the old one, to the last";
    return fail(ErrorKind::kStorage, "full", file.string());
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().where, model.string());
  EXPECT_EQ(read_whole_file(model).value(), "old");
  EXPECT_THAT(whole(), ElementsAre("session.sqlite", "mesh/model.ply"));
  EXPECT_THAT(store.verify(job).value().extra, IsEmpty()) << "nothing is left of the new one";
  ASSERT_TRUE(store.replace_file("mesh/model.ply", put("new")));
  EXPECT_EQ(read_whole_file(model).value(), "new");
  EXPECT_THAT(whole(), ElementsAre("session.sqlite", "mesh/model.ply"));
  EXPECT_EQ(store.replace_file("../elsewhere", put("")).error().kind, ErrorKind::kUsage);
  // What cannot be replaced stays, with its checksum.
  fs::remove(model);
  fs::create_directories(model / "folder");
  EXPECT_FALSE(store.replace_file("mesh/model.ply", put("newer")));
  EXPECT_EQ(store.verify(job).value().damaged.at(0).where, "mesh/model.ply");
}

TEST_F(SessionStoreTest, APathMayBeginWithTwoSlashes) {
  folder_ = "/" + folder_.string();  // as //nas/tablets
  {
    SessionStore store = open();
    EXPECT_EQ(store.add_grid(small_grid(1)).value_or(-1), 0);
  }
  const auto store = SessionStore::open(folder_, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store) << store.error().line();
  EXPECT_EQ(store->scans().value().size(), 1U);
}

TEST_F(SessionStoreTest, NumbersOfScansEndBeforeTheyOverflow) {
  {
    SessionStore store = open();
    ASSERT_TRUE(store.add_grid(small_grid(0)));
  }
  const fs::path grids = folder_ / "grids";
  fs::copy_file(grids / "000.grid", grids / "2147483647.grid");
  {
    SessionStore store = open();
    EXPECT_THAT(store.scans().value(), testing::SizeIs(1)) << "nobody's: no scan has such a number";
    EXPECT_EQ(store.next_id().value(), 1);
  }
  fs::copy_file(grids / "000.grid", grids / "99999999.grid");
  SessionStore store = open();
  ASSERT_THAT(store.scans().value(), testing::SizeIs(2));
  const Result<int> next = store.add_grid(small_grid(1));
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(next.error().line(),
            folder_.string() + ": no number is left after that of scan 99999999; go on in a new session");
  EXPECT_EQ(store.load_grid(99999999).value().z, small_grid(0).z);
  EXPECT_THAT(store.scans().value(), testing::SizeIs(2));
}

TEST_F(SessionStoreTest, ASessionOfANewerVersionIsLeftAlone) {
  { SessionStore store = open(); }
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder_ / "session.sqlite").c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "PRAGMA user_version = 99", nullptr, nullptr, nullptr), SQLITE_OK);
  ASSERT_EQ(sqlite3_close(database), SQLITE_OK);
  const auto store = SessionStore::open_or_create(folder_);
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().line(), HasSubstr("newer Dubsar"));
}

}  // namespace
}  // namespace dubsar
