// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps of a verdict, and whether its pages are of it.
#include "station/session_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/sign_off_log.h"
#include "formats/checklist_json.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "station/followed_word.h"
#include "station/made_by.h"
#include "station/results.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/support/temporary_folder.h"
#include "triangulation/placed_precision.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

class SessionPages : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(store_.add_grid(grid_));
    pose_.status = PoseStatus::kRegistered;
    ASSERT_TRUE(store_.save_poses({pose_}));
  }
  [[nodiscard]] std::string kept(const char* name) const { return **store_.load_document(name); }
  void write(const char* name, const std::string& text) const {
    std::ofstream(store_.export_folder() / name) << text;
  }
  /// Pages of the red map that is kept, and of that place.
  void write_all(const ScanPose& shown) const {
    std::filesystem::create_directories(store_.export_folder());
    write("checklist.html", "<html>");
    write("report.html", "<html>");
    write("red_map.json", kept("red_map"));
    ASSERT_TRUE(write_poses(store_.export_folder() / "poses.json", std::vector{shown}));
  }

  test::TemporaryFolder folder_;
  SessionStore store_ = SessionStore::open_or_create(folder_.path() / "s").value();
  RangeGrid grid_ = test::bumpy_scan(0);
  ScanPose pose_;
};

TEST_F(SessionPages, WhoPlacedAndWhoJudgedTheScansLastIsToldBesideWhoScanned) {
  pose_.rms_mm = 0.1;
  ASSERT_TRUE(save_followed_poses(store_, {pose_}));
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  EXPECT_FALSE(store_.load_document("programs").value()) << "the run that is under way tells it at its end";
  ASSERT_TRUE(store_.save_document("run", R"({"program":"Dubsar 0.0.9"})"));
  EXPECT_EQ(made_by(store_).placed, "Dubsar 0.0.9");
  EXPECT_EQ(made_by(store_).judged, "Dubsar 0.0.9");
  pose_.rms_mm = 0.2;
  ASSERT_TRUE(save_followed_poses(store_, {pose_}));
  EXPECT_EQ(made_by(store_).placed, program_name());
  EXPECT_EQ(made_by(store_).judged, "Dubsar 0.0.9");
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  EXPECT_EQ(made_by(store_).judged, program_name());
  EXPECT_EQ(made_by(store_).scanned, "Dubsar 0.0.9");
}

TEST_F(SessionPages, TheChecklistIsOfTheRedMapWhereSignaturesWereNotHeldAgainstItAnyMore) {
  JobContext job;
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  SignOff sign_off;
  sign_off.name = "A. Reader";
  ASSERT_TRUE(sign_session(store_, sign_off, job));
  Results results;
  results.red_map.conclusive = true;
  results.checklist.conclusive = true;
  job.cancel();
  const Status stopped = keep_verdict(store_, results, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(parse_red_map(kept("red_map"), "")->conclusive);
  EXPECT_TRUE(parse_checklist(kept("checklist"), "")->conclusive);
}

TEST_F(SessionPages, AChecklistIsKeptAnewWhereItSaysSomethingElse) {
  Checklist list;
  list.disk_free_gib = 7;
  ASSERT_TRUE(keep_verdict(store_, RedMap(), list));
  const std::string before = kept("checklist");
  list.disk_free_gib = 6;
  list.store_files = 12;
  list.store_checked = "2026-01-02T03:04:05Z";
  EXPECT_FALSE(*keep_checklist_anew(store_, list));
  EXPECT_EQ(kept("checklist"), before) << "of the moment";
  list.sign_off.emplace();
  EXPECT_FALSE(*keep_checklist_anew(store_, list)) << "whoever signs makes the pages";
  EXPECT_EQ(kept("checklist"), checklist_to_json(list));
  list.warnings.push_back({0, "pin 3 has moved"});
  EXPECT_TRUE(*keep_checklist_anew(store_, list));
  EXPECT_EQ(kept("checklist"), checklist_to_json(list));
  EXPECT_FALSE(*keep_checklist_anew(store_, list));
  ASSERT_TRUE(store_.save_document("checklist", "no JSON"));
  EXPECT_TRUE(*keep_checklist_anew(store_, list));
  EXPECT_EQ(kept("checklist"), checklist_to_json(list));
}

TEST_F(SessionPages, OfAPlaceThatTheModelCannotHoldAreNotBehind) {
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  ScanPose failed = pose_;
  failed.status = PoseStatus::kFailed;
  write_all(failed);
  EXPECT_THAT(why_pages_are_behind(store_), HasSubstr("export/poses.json is not of the scans and places"))
      << "it is well where it lies";
  pose_.model_from_scanner.translation_mm.x() = 1e9;
  failed = PlacedPrecision(grid_).judged(pose_);
  ASSERT_EQ(failed.status, PoseStatus::kFailed);
  ASSERT_TRUE(store_.save_poses({pose_}));  // as earlier versions kept it
  write_all(failed);
  EXPECT_EQ(why_pages_are_behind(store_), "");
  write_all(pose_);
  EXPECT_EQ(why_pages_are_behind(store_), "") << "pages of that version";
}

TEST_F(SessionPages, OfAPlaceThatWentToAnotherFrameAndBackAreNotBehind) {
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  pose_.model_from_scanner = RigidTransform::from_twist({0.3, -0.2, 1.1}, {41.7, -13.9, 260.1});
  write_all(pose_);
  const RigidTransform other = RigidTransform::from_twist({-2.1, 0.7, 0.4}, {612.3, -87.1, 19.9});
  ScanPose back = pose_;
  back.model_from_scanner = pose_.model_from_scanner * other.inverse() * other;
  ASSERT_NE(back.model_from_scanner.row_major(), pose_.model_from_scanner.row_major());
  ASSERT_TRUE(store_.save_poses({back}));
  EXPECT_EQ(why_pages_are_behind(store_), "");
  for (const int axis : {0, 1, 2}) {
    ScanPose moved = pose_;
    moved.model_from_scanner.translation_mm[axis] += 1e-10;
    ASSERT_TRUE(store_.save_poses({moved}));
    EXPECT_THAT(why_pages_are_behind(store_), HasSubstr("poses.json is not of")) << axis;
    moved = pose_;
    moved.model_from_scanner.rotation(axis, 0) += 1e-13;
    ASSERT_TRUE(store_.save_poses({moved}));
    EXPECT_THAT(why_pages_are_behind(store_), HasSubstr("poses.json is not of")) << axis;
  }
}

TEST_F(SessionPages, SayWhatMakesThemAnew) {
  ASSERT_TRUE(keep_verdict(store_, RedMap(), Checklist()));
  write_all(pose_);
  EXPECT_EQ(mend_of_pages(store_), kPlan);
  for (const char* mend : {kPlan, kFollowAndPlan}) {
    ASSERT_TRUE(take_pages_back(store_, "this was done; and that", mend));
    EXPECT_EQ(mend_of_pages(store_), mend);
  }
  std::filesystem::remove(store_.export_folder() / "poses.json");
  EXPECT_EQ(mend_of_pages(store_), kFollowAndPlan);
}

}  // namespace
}  // namespace dubsar
