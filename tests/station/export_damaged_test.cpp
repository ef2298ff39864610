// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export of a session that is not whole: everything that is still there is packed, and what is not is
// told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "formats/grid_file.h"
#include "formats/json_node.h"
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

class ExportDamaged : public ExportOfACopy {
 protected:
  [[nodiscard]] Outcome pack() const {
    return run_command({"export", session_.string(), "--to", bag().string(), "--json", "--without",
                        "renderings,features,grid-ply,wedges"});
  }
};

TEST_F(ExportDamaged, RowsOfAScanThatWasNotOverAreThere) {
  const fs::path left = session_ / "grids/unfinished/8";
  fs::create_directories(left);
  fs::copy(session_ / "grids/001.grid", left / "0000.grid");
  fs::copy(session_ / "grids/001.grid", left / "0001.grid");
  fs::resize_file(left / "0001.grid", 500);
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 3) << "it is no scan yet";
  EXPECT_TRUE(packed("scans/unfinished/8/0000.grid") == bytes_of(left / "0000.grid"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("scans/unfinished/8/ "),
                              HasSubstr("scans/unfinished/8/0001.grid is not here")));
  EXPECT_THAT(done.err, HasSubstr("takes them in"));
  EXPECT_THAT(packed("provenance.jsonld"), HasSubstr("scans/unfinished/8/0000.grid"));
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
  fs::remove_all(left);  // as whoever goes on with that scan leaves it
  const Outcome updated = run_command(
      {"export", session_.string(), "--to", bag().string(), "--update", "--without", "renderings,features"});
  EXPECT_EQ(updated.status, 0) << updated.err;
}

/// A file whose reading the disk refuses, whoever asks.
void make_unreadable(const fs::path& file) {
  fs::remove(file);
  fs::create_symlink("/proc/self/mem", file);
}

TEST_F(ExportDamaged, AFileThatCannotBeReadIsDamageLikeAnyOther) {
  make_unreadable(session_ / "grids/001.grid");
  make_unreadable(session_ / "export/report.html");
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 2);
  EXPECT_THAT(done.err, AllOf(HasSubstr("grids/001.grid: "), HasSubstr("export/report.html: ")));
  EXPECT_THAT(readme(), HasSubstr("Scan 1 is damaged in the session, or may not be read:"));
  EXPECT_TRUE(packed("scans/grids/002.grid") == bytes_of(session_ / "grids/002.grid"));
  EXPECT_THAT(packed("report/report.html"), HasSubstr("</html>"));
  EXPECT_EQ(pack().json()["done_before"], true);
}

TEST_F(ExportDamaged, WhatTheSessionKeepsOfLostScansIsThere) {
  fs::remove(session_ / "grids/000.grid");
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  for (const char* file : {"mesh/model.ply", "analysis/wedges.json", "export/report.html"}) {
    ASSERT_TRUE(fs::exists(session_ / file)) << file;
    EXPECT_TRUE(packed(std::string("kept/") + file) == bytes_of(session_ / file)) << file;
  }
  EXPECT_THAT(readme(),
              AllOf(HasSubstr("kept/mesh/ the mesh, as the session keeps it, made while scan 0 could "
                              "still be read: the only record"),
                    HasSubstr("are of the scans that remain; what was made")));
  EXPECT_THAT(packed("provenance.jsonld"), HasSubstr("kept/mesh/model.ply"));
  const auto poses = read_poses(bag() / "data/scans/poses.json");
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 3U) << "where it lay is known";
  EXPECT_EQ(poses->front().id, 0);
  const auto list = nlohmann::json::parse(packed("scans/scans.json"))["scans"];
  EXPECT_EQ(list[0]["damaged"], true);
  EXPECT_EQ(list[0]["status"], "registered");
  for (const char* page : {"report/report.html", "report/checklist.html"}) {
    EXPECT_THAT(packed(page),
                AllOf(HasSubstr("The session has lost scan 0:"), Not(HasSubstr("was checked against"))))
        << page;
  }
  EXPECT_EQ(nlohmann::json::parse(packed("verdict/checklist.json"))["scans_lost"],
            nlohmann::json::array({0}));
  // The poses of the package still make a mesh of the scans that are in it.
  const Outcome again =
      run_command({"stitch", (bag() / "data/scans/grids").string(), "--poses",
                   (bag() / "data/scans/poses.json").string(), "-o", at("again.ply").string()});
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(ExportDamaged, WithoutAWholeScanEverythingElseIsThere) {
  for (const char* grid : {"000", "001", "002"}) {
    fs::remove(session_ / "grids" / (std::string(grid) + ".grid"));
  }
  const Outcome done = run_command({"export", session_.string(), "--to", bag().string(), "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 0);
  EXPECT_EQ(done.json()["mesh"], false);
  EXPECT_EQ(done.json()["conclusive"], false);
  EXPECT_THAT(done.err, HasSubstr("no scan of the session stands and can be read"));
  EXPECT_THAT(readme(), AllOf(HasSubstr("There is no model, nor what is made of one"),
                              HasSubstr("what was made while they could be read is in kept/"),
                              Not(HasSubstr("scans/grids/ every"))));
  EXPECT_THAT(bytes_of(bag() / "bag-info.txt"),
              AllOf(HasSubstr("The verdict is not conclusive"), Not(HasSubstr("raw range grids"))));
  EXPECT_THAT(packed("report/report.html"), AllOf(HasSubstr("No scan is registered."), HasSubstr("</html>")));
  EXPECT_TRUE(packed("kept/mesh/model.ply") == bytes_of(session_ / "mesh/model.ply"));
  EXPECT_EQ(read_poses(bag() / "data/scans/poses.json").value().size(), 3U) << "where they lay is known";
  EXPECT_EQ(nlohmann::json::parse(packed("scans/scans.json"))["scans"].size(), 3U);
  EXPECT_EQ(nlohmann::json::parse(packed("provenance.jsonld"), nullptr, false).is_object(), true);
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
}

TEST_F(ExportDamaged, ASessionOfAnUnfinishedScanAloneIsPacked) {
  const fs::path left = at("fresh") / "grids/unfinished/1";
  { const auto made = SessionStore::open_or_create(at("fresh")); }
  fs::create_directories(left);
  RangeGrid rows = read_grid_file(session_ / "grids/001.grid").value();
  rows.device = "sim";
  ASSERT_TRUE(write_grid_file(left / "0000.grid", rows));
  const Outcome done = run_command({"export", at("fresh").string(), "--to", bag().string(), "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 0);
  EXPECT_TRUE(packed("scans/unfinished/1/0000.grid") == bytes_of(left / "0000.grid"));
  EXPECT_THAT(bytes_of(bag() / "bag-info.txt"),
              AllOf(HasSubstr("External-Description: SIMULATED. "),
                    HasSubstr("rows of scans that were not over, poses, report")));
  EXPECT_THAT(packed("report/report.html"), HasSubstr("Not conclusive"));
  EXPECT_EQ(run_command({"verify", bag().string()}).status, 0);
}

TEST_F(ExportDamaged, AFolderThatCannotBeReadIsNamedAndTheRestIsThere) {
  fs::create_directories(session_ / "grids/unfinished/8");
  fs::copy(session_ / "grids/001.grid", session_ / "grids/unfinished/8/0000.grid");
  for (const char* closed : {"grids/unfinished", "mesh", "analysis"}) {
    fs::permissions(session_ / closed, fs::perms(0));
  }
  const Outcome done = run_command({"export", session_.string(), "--to", bag().string(), "--json",
                                    "--without", "renderings,features,grid-ply"},
                                   {.bound_by_rights = true});
  const Outcome verified = run_command({"verify", session_.string()}, {.bound_by_rights = true});
  const Outcome again = run_command({"export", session_.string(), "--to", bag().string(), "--json",
                                     "--without", "renderings,features,grid-ply"},
                                    {.bound_by_rights = true});
  for (const char* closed : {"grids/unfinished", "mesh", "analysis"}) {
    fs::permissions(session_ / closed, fs::perms(0755));
  }
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.json()["scans"], 3);
  EXPECT_EQ(done.json()["mesh"], true) << "made anew of the scans";
  for (const char* closed : {"grids/unfinished", "mesh", "analysis"}) {
    EXPECT_THAT(done.err, HasSubstr(std::string(closed) + ": cannot read the folder: Permission denied"));
    EXPECT_THAT(readme(), HasSubstr("The session's folder " + std::string(closed) + " could not be read"));
  }
  EXPECT_EQ(done.json()["lacking"].size(), 3U) << done.json()["lacking"];
  EXPECT_EQ(again.json()["done_before"], true) << again.err;
  EXPECT_EQ(verified.status, 1);
  EXPECT_THAT(verified.out, HasSubstr("damaged: grids/unfinished: cannot read the folder"));
}

// A session from elsewhere may hold what Dubsar never writes: 20 000 levels once made 400 MB of an event, and
// 100 000 ended the program.
TEST_F(ExportDamaged, WhatIsNestedDeeplyStaysTheTextThatItWas) {
  const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  {
    auto store = SessionStore::open_or_create(session_);
    ASSERT_TRUE(store) << store.error().line();
    ASSERT_TRUE(store->append_event("of another program", nested(100000)));
    ASSERT_TRUE(store->append_event("the deepest that is read", nested(62)));
    ASSERT_TRUE(store->append_event("one level more", nested(63)));
    ASSERT_TRUE(store->save_document("device_settings", R"({"devices":)" + nested(100000) + "}"));
  }
  const Outcome done = pack();
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(packed("session/device_settings.json"), R"({"devices":)" + nested(100000) + "}");
  const std::string text = packed("session/events.json");
  EXPECT_LT(text.size(), 300000U);
  EXPECT_LE(json_depth(text), kMaxJsonDepth);
  const auto events = nlohmann::json::parse(text);
  const auto what = [&](const std::string& kind) -> nlohmann::json {
    const auto found =
        std::ranges::find_if(events, [&](const nlohmann::json& event) { return event["kind"] == kind; });
    return found == events.end() ? nlohmann::json() : found->at("what");
  };
  EXPECT_EQ(what("of another program"), nested(100000));
  EXPECT_EQ(what("the deepest that is read"), nlohmann::json::parse(nested(62)));
  EXPECT_EQ(what("one level more"), nested(63));
  // Nor is the program ended by a package that somebody else wrote such a list into.
  std::ofstream(bag() / "data/session/events.json") << nested(100000);
  EXPECT_EQ(run_command({"export", session_.string(), "--to", bag().string(), "--force", "--without",
                         "renderings,features,grid-ply,wedges"})
                .status,
            0);
}

TEST_F(ExportDamaged, ALimitOnThreadsIsNoDefectOfTheProgram) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "the sanitizers have threads and stacks of their own";
#endif
  const Outcome planned = run_command({"plan", session_.string()}, {.refused_threads = true});
  EXPECT_EQ(planned.status, 4);
  EXPECT_THAT(planned.err, AllOf(HasSubstr("dubsar: the system starts no more threads"),
                                 HasSubstr("ulimit -u"), Not(HasSubstr("defect"))));
}

TEST_F(ExportDamaged, ANameThatIsTooLongIsToldSo) {
  for (const std::size_t bytes : {250, 253, 256}) {  // with what is added to it; with its stamp; by itself
    const Outcome done =
        run_command({"export", session_.string(), "--to", at(std::string(bytes, 'x')).string()});
    EXPECT_EQ(done.status, 4);
    EXPECT_THAT(done.err, AllOf(HasSubstr("File name too long; choose a shorter name"),
                                Not(HasSubstr("free some space")), Not(HasSubstr("old stamp"))))
        << bytes;
  }
}

}  // namespace
}  // namespace dubsar
