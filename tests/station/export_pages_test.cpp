// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export of a session that has lost something of what was made of its scans: the rest of it stays,
// what was signed above all.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/station/support/exported.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The session, signed.
class ExportOfPages : public ExportOfACopy {
 protected:
  void SetUp() override {
    ExportOfACopy::SetUp();
    const Outcome made = run_command({"session", "sign", session_.string(), "--name", "A. Reader",
                                      "--incomplete", "the back is in plaster"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  [[nodiscard]] Outcome pack() const {
    return run_command({"-v", "export", session_.string(), "--to", bag().string(), "--json", "--without",
                        "renderings,features,grid-ply"});
  }
};

TEST_F(ExportOfPages, AreTheSignedOnesWhateverElseIsMissing) {
  ASSERT_TRUE(fs::exists(session_ / "analysis/wedges.json"));
  fs::remove(session_ / "analysis/wedges.json");
  fs::remove(session_ / "session.backup.sqlite");
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr("analysis/wedges.json: "), Not(HasSubstr("worked out anew"))));
  EXPECT_TRUE(packed("report/checklist.html") == bytes_of(session_ / "export/checklist.html"));
  EXPECT_THAT(packed("report/checklist.html"), HasSubstr("A. Reader"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("analysis/wedges.json of the session is not here: missing."),
                              Not(HasSubstr("As the session keeps them"))));
}

TEST_F(ExportOfPages, ThatWereSignedAreKeptWhereOthersHaveToBeMade) {
  fs::remove(session_ / "export/red_map.png");
  const std::string why = "export/red_map.png is not as it was stored (missing)";
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr(why), Not(HasSubstr("as they lie now"))));
  for (const char* page : {"export/checklist.html", "export/report.html", "export/red_map.json"}) {
    EXPECT_TRUE(packed(std::string("kept/") + page) == bytes_of(session_ / page)) << page;
  }
  EXPECT_THAT(packed("report/report.html"), HasSubstr("</html>"));
  EXPECT_THAT(readme(),
              AllOf(HasSubstr("kept/export/ the verdict and its pages as they were signed"),
                    HasSubstr("were made anew, for " + why), Not(HasSubstr("As the session keeps them")),
                    Not(HasSubstr("all of the scans as they stand"))))
      << "mesh and wedges are the session's";
  EXPECT_THAT(packed("provenance.jsonld"), HasSubstr("kept/export/checklist.html"));
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
}

TEST_F(ExportOfPages, ThatAreReplacedForADamagedMeshAreToldSo) {
  fs::remove(session_ / "mesh/model.ply");
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("not packed: mesh/model.ply is not as it was stored (missing)"));
  EXPECT_TRUE(packed("kept/export/checklist.html") == bytes_of(session_ / "export/checklist.html"));
  EXPECT_TRUE(fs::exists(bag() / "data/model"));
}

using ExportOfUnsignedPages = ExportOfACopy;

TEST_F(ExportOfUnsignedPages, AreThoseOfTheSessionWhereAPlaceWentToAnotherFrameAndBack) {
  const fs::path named = fs::path(at("as it was")) / "session";  // pages say the folder's name
  fs::create_directory(named.parent_path());
  fs::rename(session_, named);
  session_ = named;
  const std::string shown = bytes_of(session_ / "export/poses.json");
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    for (ScanPose& pose : poses) {
      ASSERT_EQ(pose.status, PoseStatus::kRegistered);
      double& x_mm = pose.model_from_scanner.translation_mm.x();
      x_mm = std::nextafter(x_mm, 1e3);
    }
    ASSERT_TRUE(store.save_poses(poses));
    ASSERT_FALSE(poses_to_json(poses) == shown);
  }
  EXPECT_EQ(run_command({"verify", session_.string(), "--json"}).json()["behind"].size(), 0U);
  const Outcome done = run_command({"-v", "export", session_.string(), "--to", bag().string(), "--json",
                                    "--without", "renderings,features,grid-ply"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, Not(HasSubstr("worked out anew")));
  for (const char* page : {"checklist.html", "report.html"}) {
    EXPECT_TRUE(packed(std::string("report/") + page) == bytes_of(session_ / "export" / page)) << page;
  }
}

// What was signed is not of these scans any more, and in session/events.json.
TEST_F(ExportOfPages, OfASignatureThatHoldsNoMoreAreNotKeptButNamed) {
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "2"}).status, 0);
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_FALSE(fs::exists(bag() / "data/kept"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("As the session keeps them these are not here (they are not all of "
                                        "the scans as they stand); what is here"),
                              HasSubstr("export/checklist.html"), HasSubstr("mesh/model.ply")));
}

}  // namespace
}  // namespace dubsar
