// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session whose opening is stopped while its grids are read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "formats/grid_file.h"
#include "tests/acquisition/session_support.h"
#include "tests/acquisition/spoil.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kGrids = 6;
constexpr auto kReading = SessionStore::Access::kReadOnly;
constexpr auto kWriting = SessionStore::Access::kReadWrite;

Result<SessionStore> open(const fs::path& folder, SessionStore::Access access, const JobContext& job) {
  return SessionStore::open(folder, access, SessionStore::OnDamage::kRebuild, &job);
}

class SessionStop : public testing::Test {
 protected:
  SessionStop() {
    SessionStore store = SessionStore::open_or_create(folder_).value();
    for (int k = 0; k < kGrids; ++k) {
      EXPECT_TRUE(store.add_grid(test::small_grid(k)));
    }
  }
  [[nodiscard]] std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.is_regular_file()) {
        out[entry.path().lexically_relative(folder_).generic_string()] = test::text_of_file(entry.path());
      }
    }
    return out;
  }
  /// Nothing damaged, nothing lost, nothing that a half-done opening would leave to be put right.
  void expect_whole(int scans) const {
    const Result<SessionStore> store = SessionStore::open(folder_);
    ASSERT_TRUE(store) << store.error().line();
    EXPECT_THAT(store->opening().damage, IsEmpty());
    EXPECT_THAT(store->opening().notes, IsEmpty());
    const std::vector<StoredScan> stored = store->scans().value();
    EXPECT_THAT(stored, SizeIs(scans));
    for (const StoredScan& scan : stored) {
      EXPECT_FALSE(scan.damaged) << scan.file;
    }
    JobContext job;
    EXPECT_TRUE(store->verify(job)->ok());
  }

  test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "s";
};

TEST_F(SessionStop, IsHeededBetweenGridsAndLeavesTheSessionAsItWas) {
  const auto before = files();
  for (const auto access : {kReading, kWriting}) {
    int asked = 0;
    JobContext* stopped = nullptr;
    JobContext job([&](std::string_view stage, double fraction) {
      EXPECT_EQ(stage, "checking the session");
      EXPECT_DOUBLE_EQ(fraction, static_cast<double>(asked) / kGrids);
      if (++asked == 3) {
        stopped->cancel();
      }
    });
    stopped = &job;
    const Result<SessionStore> store = open(folder_, access, job);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(store.error().line(), folder_.string() + ": stopped while the session was opened");
    EXPECT_EQ(asked, 3) << "the grids behind it are not read";
    EXPECT_TRUE(files() == before);
  }
  expect_whole(kGrids);
}

TEST_F(SessionStop, AGridThatWasNotReadToItsEndIsNotCalledDamaged) {
  JobContext job;
  job.cancel();
  const Result<SessionStore> store = open(folder_, kWriting, job);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().kind, ErrorKind::kCancelled);
  expect_whole(kGrids);
}

TEST_F(SessionStop, AGridWithoutARowIsTakenInByTheNextOpening) {
  ASSERT_TRUE(write_grid_file(folder_ / "grids/006.grid", test::small_grid(6)));
  JobContext job;
  job.cancel();
  ASSERT_FALSE(open(folder_, kWriting, job));
  EXPECT_EQ(SessionStore::open(folder_)->opening().notes,
            std::vector<std::string>{"took in grids/006.grid, which was stored and not yet listed"});
  expect_whole(kGrids + 1);
}

TEST_F(SessionStop, TablesThatAreRebuiltAreToldOfAllTheSame) {
  test::spoil_both(folder_, "made 3");
  JobContext job;
  job.cancel();
  const Result<SessionStore> looked = open(folder_, kReading, job);
  EXPECT_FALSE(looked) << "who only looks finds it again";
  const Result<SessionStore> store = open(folder_, kWriting, job);
  ASSERT_TRUE(store) << store.error().line();
  EXPECT_FALSE(store->opening().damage.empty());
}

}  // namespace
}  // namespace dubsar
