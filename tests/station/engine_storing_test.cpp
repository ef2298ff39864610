// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scan is registered while it is being stored; nothing of it is told or saved before it is on disk.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>

#include "acquisition/session_store.h"
#include "station/engine.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

std::vector<std::string> run(const fs::path& scans, const fs::path& session,
                             const std::function<void(const ScanStored&)>& on_stored,
                             std::optional<Result<EngineResult>>& result) {
  std::mutex mutex;
  std::vector<std::string> said;
  Engine engine({"replay:" + scans.string(), session, false, 0, std::nullopt}, [&](const Event& event) {
    const std::scoped_lock lock(mutex);
    if (const auto* stored = std::get_if<ScanStored>(&event)) {
      said.push_back("stored " + std::to_string(stored->id));
      on_stored(*stored);
    } else if (const auto* placed = std::get_if<ScanPlaced>(&event)) {
      said.push_back("placed " + std::to_string(placed->pose.id));
    }
  });
  JobContext job;
  result.emplace(engine.run(job));
  return said;
}

TEST(EngineStoring, EveryScanIsStoredBeforeItIsPlaced) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, folder.path() / "session", [](const ScanStored&) {}, result);
  ASSERT_TRUE(result->has_value()) << result->error().line();
  for (const char* const number : {"0", "1", "2"}) {
    const std::string id = number;
    const auto stored = std::find(said.begin(), said.end(), "stored " + id);
    const auto placed = std::find(said.begin(), said.end(), "placed " + id);
    EXPECT_NE(placed, said.end());
    EXPECT_LT(stored, placed) << id;
  }
}

TEST(EngineStoring, WhatCouldNotBeStoredLeavesNoTrace) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  const auto session = folder.path() / "session";
  const auto away = folder.path() / "away";
  std::optional<Result<EngineResult>> result;
  const std::vector<std::string> said = run(
      scans, session,
      [&](const ScanStored&) {
        // From now on there is no folder to write a grid to.
        fs::rename(session / "grids", away);
        std::ofstream(session / "grids") << "in the way";
      },
      result);
  ASSERT_FALSE(result->has_value());
  EXPECT_THAT(said, ::testing::UnorderedElementsAre("stored 0", "placed 0"));
  fs::remove(session / "grids");
  fs::rename(away, session / "grids");
  const Result<SessionStore> store = SessionStore::open(session);
  ASSERT_TRUE(store.has_value()) << store.error().line();
  std::vector<int> ids;
  const Result<std::vector<ScanPose>> poses = store->poses();
  ASSERT_TRUE(poses.has_value());
  for (const ScanPose& pose : *poses) {
    ids.push_back(pose.id);
  }
  EXPECT_THAT(ids, ElementsAre(0));
  EXPECT_EQ(store->scans()->size(), 1U);
}

}  // namespace
}  // namespace dubsar
