// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Work that is done once: what counts as done, and what does not.
#include "station/done_stamp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <functional>

#include "tests/support/remove_call.h"
#include "tests/support/temporary_folder.h"

namespace {

/// Some network file systems cannot.
bool cannot_sync_folders = false;
/// A disk that is write-protected, which says so of names that are not there, too.
bool write_protected = false;

}  // namespace

// In the place of the C library's.
extern "C" int fsync(int file) {
  struct stat info {};
  if (cannot_sync_folders && ::fstat(file, &info) == 0 && S_ISDIR(info.st_mode)) {
    errno = EINVAL;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}

extern "C" int remove(const char* name) {
  if (write_protected) {
    errno = EROFS;
    return -1;
  }
  return dubsar::test::remove_call(name);
}

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class DoneStampTest : public ::testing::Test {
 protected:
  void SetUp() override {
    put("in.ply", "a mesh");
    put("out.json", "wedges");
    put("more/drawing.svg", "lines");
  }
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_.path() / name; }
  void put(const std::string& name, const std::string& text) const {
    fs::create_directories(path(name).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
  }
  [[nodiscard]] StampedWork begin(const std::string& parameters = "{}",
                                  const std::string& verb = "analyze") const {
    Result<StampedWork> work =
        StampedWork::begin(stamp_beside(path("out.json")), verb, parameters, {path("in.ply")}, job_);
    EXPECT_TRUE(work) << work.error().line();
    return *work;
  }
  void do_it() const {
    const StampedWork work = begin();
    ASSERT_TRUE(work.start());
    ASSERT_TRUE(work.finish({path("out.json"), path("more/drawing.svg")}, job_));
  }
  [[nodiscard]] bool done(const StampedWork& work) const {
    const Result<bool> answer = work.done(job_);
    return answer && *answer;
  }

  JobContext job_;
  test::TemporaryFolder folder_;
};

TEST_F(DoneStampTest, NothingIsDoneBeforeItIs) {
  EXPECT_FALSE(done(begin()));
  do_it();
  EXPECT_TRUE(done(begin()));
}

TEST_F(DoneStampTest, WorkIsDoneAgainWhereFoldersCannotBeSynced) {
  cannot_sync_folders = true;
  do_it();
  do_it();  // this one takes the stamp of the first away
  cannot_sync_folders = false;
  EXPECT_TRUE(done(begin()));
}

TEST_F(DoneStampTest, HashesAreThoseOfXxhsum) {
  do_it();
  std::ifstream in(stamp_beside(path("out.json")));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const Result<DoneStamp> stamp = parse_done_stamp(text, "stamp");
  ASSERT_TRUE(stamp);
  EXPECT_EQ(stamp->inputs, (std::vector<StampedFile>{{"in.ply", 6, "2a8be4d062ab7fb00bba6055e4967bb0"}}));
  EXPECT_EQ(stamp->outputs[1].name, "more/drawing.svg");
  EXPECT_THAT(text, Not(HasSubstr(folder_.path().string())));
}

TEST_F(DoneStampTest, AnythingElseIsOtherWork) {
  const std::vector<std::pair<const char*, std::function<void()>>> changes{
      {"input of another size", [&] { put("in.ply", "another mesh"); }},
      {"input of the same size", [&] { put("in.ply", "a mush"); }},
      {"output cut short", [&] { put("out.json", "wed"); }},
      {"output of the same size", [&] { put("out.json", "wedgeS"); }},
      {"output gone", [&] { fs::remove(path("more/drawing.svg")); }},
      {"output a folder",
       [&] {
         fs::remove(path("out.json"));
         fs::create_directory(path("out.json"));
       }},
      {"stamp cut short", [&] { fs::resize_file(stamp_beside(path("out.json")), 40); }},
      {"stamp empty", [&] { fs::resize_file(stamp_beside(path("out.json")), 0); }},
      {"stamp of nothing",
       [&] {
         put("out.json.done", R"({"program":")" DUBSAR_VERSION
                              R"(","verb":"analyze","parameters":"{}","inputs":[],"outputs":[]})");
       }},
  };
  for (const auto& [name, change] : changes) {
    fs::remove_all(path("out.json"));
    SetUp();
    do_it();
    ASSERT_TRUE(done(begin())) << name;
    change();
    EXPECT_FALSE(done(begin())) << name;
  }
}

TEST_F(DoneStampTest, OtherParametersAndVerbsAreOtherWork) {
  do_it();
  EXPECT_FALSE(done(begin(R"({"exit":"extent"})")));
  EXPECT_FALSE(done(begin("{}", "export")));
  EXPECT_TRUE(done(begin()));
}

TEST_F(DoneStampTest, StartedWorkIsNotDone) {
  do_it();
  ASSERT_TRUE(begin().start());
  EXPECT_FALSE(fs::exists(stamp_beside(path("out.json"))));
  EXPECT_FALSE(done(begin()));
}

TEST_F(DoneStampTest, InputThatChangesMeanwhileIsNotWhatItWasMadeFrom) {
  const StampedWork work = begin();
  ASSERT_TRUE(work.start());
  put("in.ply", "a newer mesh");
  ASSERT_TRUE(work.finish({path("out.json")}, job_));
  EXPECT_FALSE(done(begin()));
}

TEST_F(DoneStampTest, ACollectionCanBeMoved) {
  do_it();
  const test::TemporaryFolder other;
  fs::copy(folder_.path(), other.path() / "moved", fs::copy_options::recursive);
  const Result<StampedWork> work = StampedWork::begin(stamp_beside(other.path() / "moved/out.json"),
                                                      "analyze", "{}", {other.path() / "moved/in.ply"}, job_);
  ASSERT_TRUE(work);
  EXPECT_TRUE(done(*work));
  fs::remove(other.path() / "moved/out.json");
  EXPECT_FALSE(done(*work));
}

TEST_F(DoneStampTest, WhatCannotBeReadOrWrittenIsTold) {
  const auto missing = StampedWork::begin(path("x.done"), "analyze", "", {path("nowhere")}, job_);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(begin().finish({path("nowhere")}, job_).error().kind, ErrorKind::kBadInput);
  const auto nowhere = StampedWork::begin(path("no/folder/x.done"), "analyze", "", {path("in.ply")}, job_);
  ASSERT_TRUE(nowhere);
  EXPECT_EQ(nowhere->finish({path("out.json")}, job_).error().kind, ErrorKind::kStorage);
  JobContext stopped;
  stopped.cancel();
  EXPECT_EQ(StampedWork::begin(path("x.done"), "analyze", "", {path("in.ply")}, stopped).error().kind,
            ErrorKind::kCancelled);
}

TEST_F(DoneStampTest, AWriteProtectedDiskIsToldInOneLineWhetherThereWasAStampOrNot) {
  const StampedWork work = begin();
  write_protected = true;
  const Status none = work.start();
  put("out.json.done", "an old one");
  const Status old = work.start();
  write_protected = false;
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().line(),
              HasSubstr("out.json.done: cannot be written: Read-only file system; choose a "
                        "folder that can be written to"));
  ASSERT_FALSE(old);
  EXPECT_THAT(old.error().line(),
              HasSubstr("out.json.done: cannot remove the old stamp: Read-only file system; "
                        "choose a folder that can be written to"));
}

}  // namespace
}  // namespace dubsar
