// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar verify: every file of a session is accounted for, and what can be mended is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "acquisition/session_store.h"
#include "core/number_text.h"
#include "core/shell_word.h"
#include "formats/corrections_json.h"
#include "formats/self_checked.h"
#include "tests/acquisition/session_support.h"
#include "tests/station/support/byte_flips.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Verify : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    scanned_ = run_command({"scan", "--auto", "--max-scans", "3", "--json", "--device",
                            "sim:?seed=2&size=18x14x9&spacing=0.4", "--session",
                            (folder_->path() / "scanned").string()});
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override {
    ASSERT_EQ(scanned_.status, 1) << scanned_.err;  // three scans do not make it conclusive
    fs::copy(scanned(), session_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(session_); }

  static fs::path scanned() { return folder_->path() / "scanned"; }
  [[nodiscard]] nlohmann::json verify(int status, const Arguments& more = {}) const {
    Arguments arguments{"verify", session_.string(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, status) << outcome.err << outcome.out;
    return outcome.json();
  }
  static std::vector<std::string> places(const nlohmann::json& errors) {
    std::vector<std::string> out;
    for (const auto& error : errors) {
      out.push_back(error["where"]);
    }
    return out;
  }

  fs::path session_ = folder_->path() / "session";
  static test::TemporaryFolder* folder_;
  static Outcome scanned_;
};
test::TemporaryFolder* Verify::folder_ = nullptr;
Outcome Verify::scanned_;

TEST_F(Verify, EveryFileOfAnUnharmedSessionIsWhole) {
  const auto report = verify(0);
  EXPECT_EQ(report["kind"], "session");
  std::vector<std::string> there;
  for (const auto& entry : fs::recursive_directory_iterator(session_)) {
    if (entry.is_regular_file() && entry.path().filename() != "session.lock") {
      there.push_back(entry.path().lexically_relative(session_).generic_string());
    }
  }
  EXPECT_THAT(report["whole"].get<std::vector<std::string>>(), testing::UnorderedElementsAreArray(there));
  EXPECT_TRUE(report["unrecorded"].empty() && report["extra"].empty());
  const Outcome quiet = run_command({"-q", "verify", session_.string()});
  EXPECT_EQ(quiet.err, "") << "no progress either";
}

TEST_F(Verify, ASignOffThatCannotBeReadIsNamedInTheAnswerToo) {
  EXPECT_THAT(verify(0)["damaged_sign_offs"], IsEmpty());
  {
    Result<SessionStore> store = SessionStore::open_or_create(session_);
    ASSERT_TRUE(store) << store.error().line();
    ASSERT_TRUE(store->append_event("signed", "no json"));
  }
  const nlohmann::json told = verify(1);
  EXPECT_EQ(told["ok"], true) << "every file is what was stored";
  ASSERT_EQ(told["damaged_sign_offs"].size(), 1U) << told.dump();
  EXPECT_THAT(told["damaged_sign_offs"][0]["where"].get<std::string>(), HasSubstr("event "));
}

TEST_F(Verify, DamagedMissingAndForeignFilesAreNamed) {
  test::flip_byte(session_ / "grids/001.grid", 3000);
  fs::remove(session_ / "export/red_map.png");
  fs::create_directories(session_ / "holiday");
  std::ofstream(session_ / "holiday/photo.jpg") << "not ours";
  std::ofstream(session_ / "export/note.txt") << "nobody recorded this";
  fs::create_symlink("/etc/passwd", session_ / "mesh/link.ply");
  const auto report = verify(1);
  EXPECT_THAT(places(report["damaged"]), ElementsAre("grids/001.grid", "export/red_map.png"));
  EXPECT_EQ(report["damaged"][1]["what"], "missing");
  EXPECT_EQ(report["extra"], nlohmann::json({"holiday/photo.jpg", "mesh/link.ply"}));
  EXPECT_EQ(report["unrecorded"], nlohmann::json({"export/note.txt"}));
  const Outcome read = run_command({"verify", session_.string()});
  EXPECT_THAT(read.out, HasSubstr("damaged: export/red_map.png: missing"));
  // What is to be typed is there whole: the window shows the same words.
  const std::string word = shell_word(fs::absolute(session_).string());
  EXPECT_THAT(read.out, HasSubstr("dubsar verify --repair " + word + " makes it anew\n"));
  EXPECT_THAT(read.out, HasSubstr("(dubsar verify --repair --from COPY " + word + ") or scan again\n"));
  EXPECT_THAT(read.out, HasSubstr("\nwhole: grids/000.grid\n"));
  EXPECT_THAT(read.out, Not(HasSubstr("whole: grids/001.grid")));
  EXPECT_THAT(run_command({"session", "list", session_.string()}).err,
              HasSubstr("warning: grids/001.grid: not the bytes"));
}

TEST_F(Verify, DerivedFilesAreMadeAnewByteForByte) {
  test::flip_byte(session_ / "mesh/model.ply", 5000);
  fs::remove(session_ / "export/poses.json");
  fs::resize_file(session_ / "analysis/wedges.json", 10);
  const auto report = verify(0, {"--repair"});
  EXPECT_EQ(report["repair"]["made_anew"].size(), 3U);
  EXPECT_THAT(report["set_aside"],
              nlohmann::json({"analysis/wedges.json.damaged-1", "mesh/model.ply.damaged-1"}));
  for (const char* file : {"mesh/model.ply", "export/poses.json"}) {
    EXPECT_TRUE(bytes_of(session_ / file) == bytes_of(scanned() / file)) << file;
  }
}

TEST_F(Verify, WhatIsWholeStaysAsItIsBesideWhatIsMended) {
  // Mesh and wedges of three scans, pages of two.
  run_command({"session", "drop", session_.string(), "2"});
  run_command({"register", session_.string()});
  run_command({"plan", session_.string()});
  const fs::path before = folder_->path() / "before the mend";
  fs::copy(session_, before, fs::copy_options::recursive);
  const auto expect_all_but = [&](const std::vector<std::string>& made) {
    for (const char* folder : {"mesh", "analysis", "export"}) {
      for (const auto& entry : fs::directory_iterator(before / folder)) {
        const std::string name = entry.path().lexically_relative(before).generic_string();
        EXPECT_TRUE(std::ranges::find(made, name) != made.end() ||
                    bytes_of(session_ / name) == bytes_of(before / name))
            << name;
      }
    }
  };
  std::ofstream(session_ / "export/six_views.png", std::ios::app) << "x";
  EXPECT_EQ(verify(0, {"--repair"})["repair"]["made_anew"], nlohmann::json({"export/six_views.png"}));
  expect_all_but({"export/six_views.png"});
  // The wedges themselves are measured on the mesh that stands.
  fs::resize_file(session_ / "analysis/wedges.json", 10);
  EXPECT_EQ(verify(0, {"--repair"})["repair"]["made_anew"], nlohmann::json({"analysis/wedges.json"}));
  expect_all_but({"export/six_views.png", "analysis/wedges.json"});
  // A mesh that no scans give any more comes as another one, and what was measured on it with it.
  test::flip_byte(session_ / "mesh/model.ply", 5000);
  const std::string wedges = bytes_of(session_ / "analysis/wedges.json");
  const auto report = verify(0, {"--repair"});
  EXPECT_THAT(report["repair"]["made_anew"].get<std::vector<std::string>>(),
              testing::IsSupersetOf({"mesh/model.ply", "analysis/wedges.json", "export/report.html"}));
  EXPECT_THAT(report["set_aside"].get<std::vector<std::string>>(),
              testing::IsSupersetOf({"mesh/model.ply.damaged-1", "analysis/wedges.json.before-1"}));
  EXPECT_TRUE(bytes_of(session_ / "analysis/wedges.json.before-1") == wedges);
  EXPECT_THAT(report["behind"], IsEmpty());
}

/// Signed, and what a person says of the wedges since makes them others.
TEST_F(Verify, PagesAndWedgesThatAreLostTogetherAreMadeOfEachOther) {
  ASSERT_EQ(run_command({"session", "describe", session_.string(), "--museum-number", "BM 1"}).status, 0);
  ASSERT_EQ(
      run_command({"session", "sign", session_.string(), "--name", "A. Reader", "--incomplete", "a trial"})
          .status,
      0);
  WedgeCorrection gone;
  gone.at_mm = {{1, 2, 3}};
  ASSERT_TRUE(write_corrections(session_ / "analysis/wedges.corrections.json", {"model.ply", {gone}}));
  for (const std::vector<std::string>& lost :
       {std::vector<std::string>{"export/report.html"},
        std::vector<std::string>{"export/report.html", "export/checklist.html"}}) {
    for (const std::string& name : lost) {
      fs::remove(session_ / name);
    }
    fs::remove(session_ / "analysis/wedges.json");
    const auto report = verify(0, {"--repair"});
    EXPECT_THAT(report["behind"], IsEmpty()) << report["behind"];
    EXPECT_THAT(report["repair"]["made_anew"].get<std::vector<std::string>>(),
                testing::IsSupersetOf({"analysis/wedges.json", "export/report.html"}));
    for (const char* page : {"export/report.html", "export/checklist.html"}) {
      EXPECT_THAT(bytes_of(session_ / page), testing::AllOf(HasSubstr("A. Reader"), HasSubstr("BM 1")))
          << page;
      EXPECT_THAT(bytes_of(session_ / page), Not(HasSubstr("<h2>Behind</h2>"))) << page;
    }
    const auto red_map = nlohmann::json::parse(bytes_of(session_ / "export/red_map.json"));
    EXPECT_FALSE(red_map.contains("behind"));
    const auto wedges = nlohmann::json::parse(bytes_of(session_ / "analysis/wedges.json"));
    EXPECT_THAT(bytes_of(session_ / "export/report.html"),
                HasSubstr(wedges["wedges"].empty()
                              ? "No wedges were found; " + counted(wedges["rejected"].size(), "hollow")
                              : counted(wedges["wedges"].size(), "wedge") +
                                    (wedges["wedges"].size() == 1 ? " was measured" : " were measured")));
    gone.at_mm.front().x() += 1;
    ASSERT_TRUE(write_corrections(session_ / "analysis/wedges.corrections.json", {"model.ply", {gone}}));
  }
}

TEST_F(Verify, PagesThatWereBehindAndAreLostComeBackAsSuch) {
  ASSERT_EQ(run_command({"session", "drop", session_.string(), "2"}).status, 0);
  fs::remove_all(session_ / "export");
  const auto report = verify(0, {"--repair"});
  EXPECT_EQ(report["behind"].size(), 2U) << report["behind"];
  for (const char* page : {"export/report.html", "export/checklist.html"}) {
    EXPECT_THAT(bytes_of(session_ / page), HasSubstr("<h2>Behind</h2>")) << page;
    EXPECT_THAT(bytes_of(session_ / page), HasSubstr("dubsar register and dubsar plan")) << page;
  }
  EXPECT_TRUE(nlohmann::json::parse(bytes_of(session_ / "export/red_map.json")).contains("behind"));
}

TEST_F(Verify, AGridComesBackFromACopyAndFromNowhereElse) {
  test::flip_byte(session_ / "grids/001.grid", 3000);
  test::flip_byte(session_ / "mesh/model.ply", 5000);
  const std::string damaged = bytes_of(session_ / "grids/001.grid");
  const auto alone = verify(1, {"--repair"});
  EXPECT_THAT(places(alone["repair"]["beyond"]), ElementsAre("grids/001.grid", "mesh/model.ply"));
  EXPECT_THAT(alone["repair"]["beyond"][1]["what"].get<std::string>(), HasSubstr("without grids/001.grid"));
  EXPECT_EQ(run_command({"verify", (session_ / "grids/001.grid").string(), "--repair"}).status, 2);
  EXPECT_TRUE(bytes_of(session_ / "grids/001.grid") == damaged) << "left as it is";
  const auto with_copy = verify(0, {"--repair", "--from", scanned().string()});
  EXPECT_EQ(with_copy["repair"]["restored"], nlohmann::json({"grids/001.grid", "mesh/model.ply"}));
  EXPECT_TRUE(bytes_of(session_ / "grids/001.grid.damaged-1") == damaged);
  EXPECT_TRUE(bytes_of(session_ / "grids/001.grid") == bytes_of(scanned() / "grids/001.grid"));
}

TEST_F(Verify, WhatAPersonWroteIsCheckedByItsOwnSumAndNeverMadeAnew) {
  const std::string name = "analysis/wedges.corrections.json";
  const std::string text = with_own_checksum("{\"unit\":\"mm\",\"mesh\":\"model.ply\",\"corrections\":[]}");
  std::ofstream(session_ / name) << text;
  EXPECT_THAT(verify(0)["whole"], Contains(name));
  const fs::path copy = folder_->path() / "copy";
  fs::copy(session_, copy, fs::copy_options::recursive);
  test::flip_byte(session_ / name, 20);
  EXPECT_THAT(places(verify(1)["damaged"]), ElementsAre(name));
  EXPECT_THAT(places(verify(1, {"--repair"})["repair"]["beyond"]), ElementsAre(name));
  fs::resize_file(session_ / name, 0);
  EXPECT_THAT(places(verify(1)["damaged"]), ElementsAre(name)) << "with nothing left of its checksum";
  EXPECT_EQ(verify(0, {"--repair", "--from", copy.string()})["repair"]["restored"], nlohmann::json({name}));
  EXPECT_EQ(bytes_of(session_ / name), text);
}

TEST_F(Verify, RowsOfAScanThatWasNotOverAreCheckedByTheirOwnSum) {
  const fs::path rows = session_ / "grids/unfinished/1";
  fs::create_directories(rows);
  for (const char* file : {"0000.grid", "0001.grid", "0002.grid"}) {
    fs::copy(session_ / "grids/001.grid", rows / file);
  }
  const auto whole = verify(0);
  EXPECT_THAT(whole["whole"], Contains("grids/unfinished/1/0000.grid"));
  EXPECT_THAT(whole["unrecorded"], IsEmpty());
  const fs::path copy = folder_->path() / "copy with rows";
  fs::copy(session_, copy, fs::copy_options::recursive);
  test::flip_byte(rows / "0001.grid", 3000);
  fs::resize_file(rows / "0002.grid", 0);
  const auto report = verify(1);
  EXPECT_THAT(places(report["damaged"]),
              ElementsAre("grids/unfinished/1/0001.grid", "grids/unfinished/1/0002.grid"));
  EXPECT_EQ(report["damaged"][0]["what"], "its own checksum does not fit");
  EXPECT_EQ(verify(0, {"--repair", "--from", copy.string()})["repair"]["restored"].size(), 2U);
}

TEST_F(Verify, NoFlippedBitOfAnyFilePasses) {
  std::ofstream(session_ / "analysis/selections.json") << with_own_checksum("{\"selections\":[]}");
  const std::uint64_t seed = std::random_device()();
  Random random(seed);
  for (const auto& [name, tally] : test::flip_bytes(session_, 12, random)) {
    EXPECT_THAT(tally.missed, IsEmpty()) << name << ", seed " << seed;
    EXPECT_EQ(tally.idle, 0U) << name << ", seed " << seed;
    EXPECT_EQ(tally.tried, std::min<std::uintmax_t>(12, tally.bytes)) << name;
  }
  EXPECT_TRUE(test::passes_verification(session_)) << "each was put back";
}

TEST_F(Verify, TablesAreRebuiltAndTheDamagedOnesKept) {
  const auto events = run_command({"session", "list", session_.string(), "--json"}).json();
  for (std::uintmax_t at = 100; at < 4096; at += 64) {
    test::flip_byte(session_ / "session.sqlite", at);
  }
  const auto before = verify(1);
  EXPECT_THAT(places(before["damaged"]), Not(IsEmpty()));
  const auto after = verify(0, {"--repair"});
  EXPECT_THAT(after["repair"]["notes"].dump(), HasSubstr("rebuilt the database"));
  EXPECT_THAT(after["set_aside"].dump(), HasSubstr("session.sqlite.damaged-1"));
  EXPECT_EQ(run_command({"session", "list", session_.string(), "--json"}).json()["scans"], events["scans"]);
}

TEST_F(Verify, ABagIsNotCalledValidByAManifestThatNobodyRead) {
  const std::string bag = (folder_->path() / "bag").string();
  ASSERT_EQ(run_command({"export", scanned().string(), "--to", bag, "--without",
                         "renderings,features,wedges,grid-ply"})
                .status,
            0);
  EXPECT_THAT(run_command({"verify", bag}).out, HasSubstr("0 faults: the bag is complete and valid\n"));
  std::ofstream(bag + "/manifest-crc32.txt") << "00000000  data/README.txt\n";
  const Outcome outcome = run_command({"verify", bag});
  EXPECT_THAT(outcome.out, HasSubstr("cannot be checked here: manifest-crc32.txt\n"));
  EXPECT_THAT(outcome.out, HasSubstr("the bag is complete, and valid by what can be checked here\n"));
  std::ofstream(bag + "/manifest-md5.txt") << "00000000000000000000000000000000  data/README.txt\n";
  EXPECT_EQ(run_command({"verify", bag}).status, 1);
}

TEST_F(Verify, WhatCannotBeVerifiedIsToldInOneLine) {
  const fs::path other = folder_->path() / "other";
  fs::create_directories(other);
  const std::string good = session_.string();
  for (const Arguments& arguments :
       {Arguments{"verify", other.string()}, Arguments{"verify", (other / "nothing").string()},
        Arguments{"verify", good, "--from", scanned().string()},
        Arguments{"verify", good, "--repair", "--from", good},
        Arguments{"verify", good, "--repair", "--from", other.string()}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.complaints().size(), 1U) << outcome.err;
  }
}

}  // namespace
}  // namespace dubsar
