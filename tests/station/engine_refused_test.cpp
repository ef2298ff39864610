// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Words of the operator that come to nothing: said, and nothing is changed by them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "acquisition/session_store.h"
#include "station/engine.h"
#include "station/session_pages.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

class Refused : public ::testing::Test {
 protected:
  /// Of a run on that many recorded scans.
  [[nodiscard]] EngineOptions options_of(int count) const {
    const auto scans = test::write_bumpy_scans(folder_.path() / "scans", count);
    return {"replay:" + scans.string(), folder_.path() / "s", false, 0, std::nullopt};
  }
  void note(const Event& event) {
    if (const auto* notice = std::get_if<Notice>(&event)) {
      const std::scoped_lock lock(mutex_);
      notices_ += notice->text + "\n";
    }
  }
  test::TemporaryFolder folder_;
  JobContext job_;
  std::mutex mutex_;
  std::string notices_;
};

TEST_F(Refused, WhatARunIsStoppedBeforeIsToldOf) {
  std::promise<void> placed;
  std::promise<void> said;
  Engine engine(options_of(3), [&](const Event& event) {
    note(event);
    if (const auto* one = std::get_if<ScanPlaced>(&event); one != nullptr && one->pose.id == 1) {
      placed.set_value();
      said.get_future().wait();
    }
  });
  std::optional<Result<EngineResult>> result;
  std::jthread runs([&] { result.emplace(engine.run(job_)); });
  placed.get_future().wait();
  EXPECT_TRUE(engine.post(DropScan{0, "a hand in it"}));
  job_.cancel();
  said.set_value();
  runs.join();
  ASSERT_FALSE(*result);
  EXPECT_THAT(notices_, HasSubstr("what was said meanwhile of scans was not heeded; say it again"));
}

TEST_F(Refused, WhatIsNotDoneLeavesThePagesAsTheyStand) {
  const auto why = [&] {
    return why_pages_are_behind(
        SessionStore::open(folder_.path() / "s", SessionStore::Access::kReadOnly).value());
  };
  EngineOptions options = options_of(1);
  ASSERT_TRUE(Engine(options, nullptr).run(job_).has_value());
  ASSERT_EQ(why(), "");
  options.first_commands = {RestoreScan{0}, DropScan{7, "no such scan"}, LabelPins{7, {}, 1.5},
                            UnlockScan{0}};
  Engine engine(options, [&](const Event& event) {
    note(event);
    const auto* notice = std::get_if<Notice>(&event);
    if (notice != nullptr && notice->text.find("scan 0 is not locked") != std::string::npos) {
      job_.cancel();  // before the pages are made anew
    }
  });
  ASSERT_FALSE(engine.run(job_).has_value());
  EXPECT_THAT(notices_, HasSubstr("scan 0 was not taken out"));
  EXPECT_EQ(why(), "");
}

}  // namespace
}  // namespace dubsar
