// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export of a session with a scan that is stored and has no place yet, as a kill in the middle of a
// scan and a scan that goes on leave it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "formats/json_node.h"
#include "tests/station/support/exported.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ExportOfUnplaced : public ExportOfACopy {
 protected:
  [[nodiscard]] Outcome pack(const std::vector<std::string>& more = {}) const {
    return pack_without("renderings,features,grid-ply,wedges", more);
  }
  /// That all that the package says of scan `id` is that it has no place.
  void expect_told(const Outcome& done, int id) const {
    const std::string scan = "scan " + std::to_string(id);
    EXPECT_THAT(done.json()["lacking"].dump(), HasSubstr("No place was worked out yet for " + scan + ":"));
    EXPECT_THAT(done.err, AllOf(HasSubstr("no place was worked out yet for " + scan + ","),
                                HasSubstr("dubsar register places")));
    EXPECT_THAT(readme(),
                AllOf(HasSubstr("Without a place so far, and in neither model nor verdict: " + scan + "."),
                      HasSubstr("No place was worked out yet for " + scan + ":")));
    for (const char* page : {"report/report.html", "report/checklist.html"}) {
      EXPECT_THAT(packed(page), AllOf(HasSubstr("No place was worked out yet for " + scan + ":"),
                                      HasSubstr("<dt>Not placed yet</dt><dd>" + scan + ",")))
          << page;
    }
    EXPECT_THAT(packed("report/report.html"), HasSubstr("<td>not placed yet</td>"));
    EXPECT_EQ(nlohmann::json::parse(packed("verdict/checklist.json"))["scans_unplaced"],
              nlohmann::json::array({id}));
    EXPECT_EQ(
        nlohmann::json::parse(packed("scans/scans.json"))["scans"][static_cast<std::size_t>(id)]["status"],
        "not placed");
    EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
  }
};

TEST_F(ExportOfUnplaced, AScanThatWasNotPlacedBeforeTheKillIsTold) {
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    std::erase_if(poses, [](const ScanPose& pose) { return pose.id == 1; });
    ASSERT_TRUE(store.save_poses(poses));
  }
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 3);
  expect_told(done, 1);
  ASSERT_LE(run_command({"register", session_.string()}).status, 1);
  const Outcome placed = pack({"--update"});
  ASSERT_EQ(placed.status, 0) << placed.err;
  EXPECT_THAT(placed.json()["lacking"].dump() + placed.err + readme() + packed("report/report.html"),
              Not(HasSubstr("place was worked out yet")))
      << "as the line says";
}

// The pages of the session are of all other scans, whole and unsigned: nothing but the list of scans differs.
TEST_F(ExportOfUnplaced, PagesThatKnowNothingOfAScanAreNotTakenForItsVerdict) {
  {
    SessionStore store = SessionStore::open(session_).value();
    ASSERT_EQ(store.add_grid(store.load_grid(1).value()).value(), 3);
  }
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 4);
  expect_told(done, 3);
  // One that was taken out needs no place.
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "3"}).status, 0);
  const Outcome less = pack({"--update"});
  ASSERT_EQ(less.status, 0) << less.err;
  EXPECT_THAT(less.json()["lacking"].dump() + less.err + readme(),
              Not(HasSubstr("place was worked out yet")));
}

TEST_F(ExportOfUnplaced, AScanOfNoCertainPlaceIsTold) {
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    std::ranges::find(poses, 1, &ScanPose::id)->status = PoseStatus::kUnsure;
    ASSERT_TRUE(store.save_poses(poses));
  }
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.json()["lacking"].dump(), HasSubstr("No certain place was found for scan 1:"));
  EXPECT_THAT(done.err, HasSubstr("no certain place was found for scan 1,"));
  EXPECT_THAT(readme(), HasSubstr("No certain place was found for scan 1:"));
}

TEST_F(ExportOfUnplaced, PosesThatDoNotFollowWhatWasSaidAreTold) {
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "1"}).status, 0);
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  const std::string behind = "the poses do not follow yet what was said: scan 1 has been taken out";
  EXPECT_THAT(done.err, HasSubstr(behind + "; run dubsar register"));
  EXPECT_THAT(done.json()["lacking"].dump(), HasSubstr("Take care: " + behind));
  EXPECT_THAT(packed("provenance.jsonld"), HasSubstr(behind));
  ASSERT_LE(run_command({"register", session_.string()}).status, 1);
  const Outcome followed = pack({"--update"});
  ASSERT_EQ(followed.status, 0) << followed.err;
  EXPECT_THAT(followed.json()["lacking"].dump() + followed.err + packed("provenance.jsonld"),
              Not(HasSubstr("do not follow")));
}

}  // namespace
}  // namespace dubsar
