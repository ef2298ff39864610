// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/results.h"

#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(PageFacts, WhatWasPredictedAndWhatCameOfItStayInTheSession) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  PageFacts facts;
  facts.device = "sim:";
  facts.timings = {{"register", 1.5}};
  facts.gains = {{.scan = 3, .predicted_mm2 = 12.5, .actual_mm2 = 11.0},
                 {.scan = 4, .predicted_mm2 = std::nullopt, .actual_mm2 = 2.0}};
  facts.wedges = "two wedges";
  ASSERT_TRUE(keep_page_facts(*store, facts));
  const PageFacts read = page_facts_of(*store);
  EXPECT_EQ(read.device, "sim:");
  EXPECT_EQ(read.wedges, "two wedges");
  ASSERT_EQ(read.gains.size(), 2U);
  EXPECT_EQ(read.gains[0].scan, 3);
  EXPECT_EQ(read.gains[0].predicted_mm2, 12.5);
  EXPECT_EQ(read.gains[0].actual_mm2, 11.0);
  EXPECT_FALSE(read.gains[1].predicted_mm2.has_value());
}

/// Of a session without a scan: the pages, and the mesh where there is one.
Result<Deliverables> keep_pages(SessionStore& store, JobContext& job, const Mesh& mesh = {}) {
  const RedMap red_map;
  const Checklist checklist;
  const std::vector<ScanPose> poses;
  const ReportInput input{.title = "T 1",
                          .tablet = {},
                          .tool_version = "Dubsar",
                          .when = "2026-01-01T00:00:00Z",
                          .device = "sim:",
                          .model = mesh,
                          .red_map = red_map,
                          .checklist = checklist,
                          .scans = poses,
                          .red_points = {},
                          .tablet_from_model = {},
                          .wedges = {},
                          .accuracy = {},
                          .calibration = {},
                          .not_measured = {},
                          .timings = {},
                          .longest_px = 64};
  return keep_deliverables(store, input, job);
}

TEST(Deliverables, AFolderThatIsALinkToAnotherDiskStaysAFolderOfTheSession) {
  const test::TemporaryFolder folder;
  const std::filesystem::path session = folder.path() / "session";
  Result<SessionStore> store = SessionStore::open_or_create(session);
  ASSERT_TRUE(store) << store.error().line();
  std::filesystem::rename(session / "export", folder.path() / "disk");
  std::filesystem::create_directory_symlink(folder.path() / "disk", session / "export");
  JobContext job;
  const Result<Deliverables> kept = keep_pages(*store, job);
  ASSERT_TRUE(kept) << kept.error().line();
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "disk" / "report.html"));
}

TEST(Deliverables, PagesThatAreStoppedLeaveTheOldOnesTheirChecksums) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.faces = {{0, 1, 2}};
  JobContext job;
  ASSERT_TRUE(keep_pages(*store, job, triangle));
  const std::vector<std::string> before = store->verify(job).value().whole;
  EXPECT_EQ(before.size(), 8U) << "the database, the mesh and six files of pages";
  JobContext stopped;
  stopped.cancel();
  const Result<Deliverables> none = keep_pages(*store, stopped, triangle);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(store->verify(job).value().whole, before);
}

TEST(Deliverables, AFolderThatCannotBeMadeIsSaid) {
  const test::TemporaryFolder folder;
  const std::filesystem::path session = folder.path() / "session";
  Result<SessionStore> store = SessionStore::open_or_create(session);
  ASSERT_TRUE(store) << store.error().line();
  std::filesystem::remove(session / "mesh");
  test::put(session / "mesh", "no folder");
  JobContext job;
  const Result<Deliverables> kept = keep_pages(*store, job);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().where, (session / "mesh").string());
}

}  // namespace
}  // namespace dubsar
