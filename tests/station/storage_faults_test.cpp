// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A power switch and a disk that refuses, at every verb that writes. dubsar-crash does the same at length.

#include <gtest/gtest.h>

#include <memory>

#include "core/random.h"
#include "tests/station/support/output_trial.h"
#include "tests/station/support/storage_trial.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Fault;
using test::StorageTrials;
using test::TrialOutcome;
using test::WritingVerb;

constexpr std::uint64_t kSeed = 20260101;

class StorageFaults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
#ifndef DUBSAR_SANITIZED
    folder_ = new test::TemporaryFolder;
    trials_ = new StorageTrials(folder_->path(), 5);
#endif
  }
  static void TearDownTestSuite() {
    delete trials_;
    delete folder_;
  }
  void SetUp() override {
    if (trials_ == nullptr) {
      GTEST_SKIP() << "a sanitizer's own library has to be loaded first";
    }
  }
  static test::TemporaryFolder* folder_;
  static StorageTrials* trials_;
};
test::TemporaryFolder* StorageFaults::folder_ = nullptr;
StorageTrials* StorageFaults::trials_ = nullptr;

std::string told(const auto& verb, const Fault& fault, const TrialOutcome& outcome) {
  std::string out =
      verb.name + ", " + fault.what + " at call " + std::to_string(fault.at) + " (" + outcome.met + "):";
  for (const std::string& one : outcome.faults) {
    out += "\n  " + one;
  }
  return out + "\n" + outcome.command.err;
}

TEST_F(StorageFaults, NothingStoredIsLostToAKillOrARefusal) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Random random(kSeed);
  int killed = 0;
  for (const WritingVerb& verb : test::writing_verbs()) {
    const TrialOutcome whole = trials_->undisturbed(verb);
    EXPECT_TRUE(whole.faults.empty()) << told(verb, {}, whole);
    ASSERT_GT(whole.calls, 0) << verb.name;
    for (const char* what : {"KILL", "KILL_AFTER", "KILL_HALF", "ENOSPC", "EIO", "EROFS"}) {
      const auto call = random.below(static_cast<std::uint64_t>(whole.calls));
      const Fault fault{.what = what,
                        .at = 1 + static_cast<std::int64_t>(call),
                        .stays = random.below(2) == 0,
                        .kill_after_s = -1};
      const TrialOutcome outcome = trials_->run(verb, fault);
      EXPECT_TRUE(outcome.faults.empty()) << told(verb, fault, outcome);
      killed += outcome.killed ? 1 : 0;
    }
  }
  EXPECT_GE(killed, 30);
}

TEST_F(StorageFaults, FilesAreWholeOrAsTheyWereAndTheVerbCanBeStartedAgain) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const test::TemporaryFolder folder;
  test::OutputTrials trials(folder.path(), 5);
  Random random(kSeed);
  for (const test::OutputVerb& verb : test::output_verbs()) {
    const TrialOutcome whole = trials.undisturbed(verb);
    ASSERT_TRUE(whole.faults.empty()) << told(verb, {}, whole);
    ASSERT_GT(whole.calls, 0) << verb.name;
    const char* const refusal = random.below(2) == 0 ? "ENOSPC" : "EIO";
    for (const char* what : {"KILL_HALF", refusal}) {
      const auto call = random.below(static_cast<std::uint64_t>(whole.calls));
      const Fault fault{.what = what,
                        .at = 1 + static_cast<std::int64_t>(call),
                        .stays = random.below(2) == 0,
                        .kill_after_s = -1};
      const TrialOutcome outcome = trials.run(verb, fault);
      EXPECT_TRUE(outcome.faults.empty()) << told(verb, fault, outcome);
    }
  }
}

}  // namespace
}  // namespace dubsar
