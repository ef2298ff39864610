// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// No verb writes its result into a session or package, where every file has its checksum.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "build_paths.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Outputs : public ::testing::Test {
 protected:
  Outputs() {
    fs::copy(fs::path(DUBSAR_SOURCE_DIR) / "tests/data/sessions/schema1_first", session(),
             fs::copy_options::recursive);
    for (const auto& file : fs::recursive_directory_iterator(session())) {
      fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    }
  }
  [[nodiscard]] fs::path session() const { return folder_.path() / "tablet"; }
  [[nodiscard]] std::string in_session(const char* name) const { return (session() / name).string(); }
  [[nodiscard]] std::string mesh() const { return in_session("mesh/model.ply"); }
  [[nodiscard]] fs::path beside(const char* name) const { return folder_.path() / name; }

  [[nodiscard]] std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& file : fs::recursive_directory_iterator(session())) {
      if (file.is_regular_file()) {
        all[file.path().string()] = bytes_of(file.path());
      }
    }
    return all;
  }

  void expect_refused(const Arguments& arguments) const {
    const std::map<std::string, std::string> before = files();
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments.front() << ": " << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("beside the session: " + beside("tablet-").string()));
    EXPECT_TRUE(files() == before) << arguments.front();
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Outputs, OfNoVerbGoIntoASession) {
  expect_refused({"stitch", session(), "-o", mesh()});
  expect_refused({"analyze", mesh(), "-o", in_session("analysis/wedges.json")});
  expect_refused({"analyze", mesh(), "-o", beside("wedges.json"), "--pictures", in_session("pictures")});
  expect_refused({"analyze", mesh(), "-o", beside("wedges.json"), "--svg", in_session("export")});
  expect_refused({"analyze", mesh(), "-o", beside("wedges.json"), "--mesh-out", mesh()});
  expect_refused({"mesh", "convert", mesh(), in_session("mesh/model.stl")});
  expect_refused(
      {"mesh", "section", mesh(), "--from", "0,0,0", "--to", "1,0,0", "-o", in_session("cut.csv")});
  expect_refused({"register", session(), "-o", in_session("session.sqlite")});
  expect_refused({"plan", session(), "-o", in_session("red_map.json")});
  expect_refused({"plan", session(), "--page", in_session("export/checklist.html")});
  expect_refused({"simulate", "tablet", "--size", "8x8x4", "--spacing", "1", "-o", session()});
}

TEST_F(Outputs, NoPackageGoesIntoASessionUnderAnyName) {
  expect_refused({"export", session(), "--to", in_session("package")});
  expect_refused({"export", session(), "--to", in_session("export/package/")});
  expect_refused({"export", session(), "--to", session().string() + "/", "--force"});
  expect_refused({"export", session(), "--to", in_session("grids/../package")});
  fs::create_directory_symlink(session() / "mesh", beside("shortcut"));
  expect_refused({"export", session(), "--to", beside("shortcut") / "package"});
}

TEST_F(Outputs, OfNoVerbGoIntoAPackage) {
  const fs::path bag = beside("bag");
  fs::create_directories(bag / "data" / "model");
  std::ofstream(bag / "bagit.txt") << "BagIt-Version: 1.0\n";
  for (const Arguments& arguments : {Arguments{"mesh", "convert", mesh(), bag / "data" / "model" / "m.stl"},
                                     {"simulate", "tablet", "--size", "8x8x4", "--spacing", "1", "-o", bag},
                                     {"export", session(), "--to", bag / "data" / "inner"}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments.front() << ": " << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("beside the package: " + beside("bag-").string()));
  }
  EXPECT_TRUE(fs::is_empty(bag / "data" / "model"));
}

TEST_F(Outputs, OfABareNameGoIntoNoSessionThatOneStandsIn) {
  const fs::path stood = fs::current_path();
  fs::current_path(session());
  expect_refused({"analyze", "mesh/model.ply", "-o", "wedges.json"});
  expect_refused({"export", ".", "--to", "package"});
  fs::current_path(stood);
}

TEST_F(Outputs, ReplaceNeitherWhatIsReadNorEachOther) {
  const fs::path own = beside("own.ply");
  fs::copy_file(mesh(), own);
  const std::string before = bytes_of(own);
  const fs::path link = beside("link.ply");
  fs::create_hard_link(own, link);
  for (const Arguments& arguments : {Arguments{"analyze", own, "-o", own},
                                     {"analyze", own, "-o", beside("w.json"), "--mesh-out", link},
                                     {"mesh", "convert", own, beside("shut/../own.ply")},
                                     {"mesh", "section", own, "--from", "0,0,0", "--to", "1,0,0", "-o", own},
                                     {"mesh", "part", own, "--selection", "line 3", "-o", own},
                                     {"analyze", own, "-o", beside("w.json"), "--svg", beside("w.json")}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a name of its own"));
    EXPECT_EQ(bytes_of(own), before);
    EXPECT_FALSE(fs::exists(beside("w.json")));
  }
}

TEST_F(Outputs, ReplaceNothingThatAPersonHasSaid) {
  const fs::path own = beside("own.ply");
  fs::copy_file(mesh(), own);
  const std::string corrections = R"({"unit":"mm","mesh":"own.ply","corrections":[]})";
  for (const char* name : {"said.json", "w.corrections.json", "own.selections.json"}) {
    std::ofstream(beside(name)) << corrections;
  }
  const fs::path said = beside("said.json");
  for (const Arguments& arguments :
       {Arguments{"analyze", own, "-o", said, "--corrections", said},
        {"analyze", own, "-o", beside("w.json"), "--invariants", beside("w.corrections.json")},
        {"wedges", "correct", own, "-o", beside("w.json"), "--undo", "--invariants",
         beside("w.corrections.json")},
        {"mesh", "part", own, "--selection", "line 3", "--selections", said, "-o", said},
        {"mesh", "part", own, "--selection", "line 3", "-o", beside("own.selections.json")}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a name of its own"));
    for (const char* name : {"said.json", "w.corrections.json", "own.selections.json"}) {
      EXPECT_EQ(bytes_of(beside(name)), corrections) << name;
    }
  }
}

TEST_F(Outputs, ReplaceNoScanOfTheFolderThatIsRead) {
  const fs::path scans = beside("scans");
  ASSERT_EQ(
      run_command({"simulate", "scans", "--tablet", mesh(), "--views", "2", "--spacing", "0.05", "-o", scans})
          .status,
      0);
  const fs::path scan = scans / "scan_000.ply";
  const std::string before = bytes_of(scan);
  ASSERT_FALSE(before.empty());
  const std::string poses = (scans / "truth_poses.json").string();
  for (const Arguments& arguments : {Arguments{"stitch", scans, "--poses", poses, "-o", scan},
                                     {"register", scans, "-o", scan},
                                     {"register", scan, "-o", scan},
                                     {"plan", scans, "--poses", poses, "-o", scan}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a scan would be written over")) << arguments.front();
    EXPECT_TRUE(bytes_of(scan) == before) << arguments.front();
  }
  const std::string kept = bytes_of(poses);
  for (const Arguments& arguments : {Arguments{"stitch", scans, "--poses", poses, "-o", poses},
                                     {"register", scans, "--from-poses", poses, "-o", poses},
                                     {"register", scans, "--pins", poses, "-o", poses},
                                     {"plan", scans, "--poses", poses, "-o", poses},
                                     {"plan", scans, "--poses", poses, "--page", poses}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a name of its own")) << arguments.front();
    EXPECT_TRUE(bytes_of(poses) == kept) << arguments.front();
  }
  // What an earlier run left there is no scan: the same command writes it again.
  for (int run = 0; run < 2; ++run) {
    const Outcome outcome = run_command({"stitch", scans, "--poses", poses, "-o", scans / "mesh.ply"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

/// In a package's `scans/ply` a scan is called after the file that it once came from.
TEST_F(Outputs, ReplaceNoScanThatGoesByAnotherNameThanItsFile) {
  const fs::path scans = beside("scans");
  ASSERT_EQ(
      run_command({"simulate", "scans", "--tablet", mesh(), "--views", "1", "--spacing", "0.05", "-o", scans})
          .status,
      0);
  const fs::path scan = scans / "000.ply";
  const fs::path cut_short = scans / "001.ply";
  std::string named = bytes_of(scans / "scan_000.ply");
  named.insert(named.find("element vertex"), "obj_info dubsar_source first.ply\n");
  fs::remove(scans / "scan_000.ply");
  std::ofstream(scan, std::ios::binary) << named;
  std::ofstream(cut_short, std::ios::binary) << named.substr(0, named.size() / 2);
  const std::string half = bytes_of(cut_short);
  for (const fs::path& output : {scan, cut_short}) {
    for (const Arguments& arguments : {Arguments{"register", scans, "-o", output},
                                       {"plan", scans, "-o", output},
                                       {"plan", scans, "--page", output},
                                       {"stitch", scans, "-o", output}}) {
      const Outcome outcome = run_command(arguments);
      EXPECT_EQ(outcome.status, 2) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("a scan would be written over")) << arguments.front();
      EXPECT_TRUE(bytes_of(scan) == named && bytes_of(cut_short) == half) << arguments.front();
    }
  }
  const Outcome among = run_command({"plan", scans, "--states", scans});
  EXPECT_EQ(among.status, 2) << among.err;
  EXPECT_THAT(among.err, HasSubstr("would be read as scans of this folder"));
  EXPECT_FALSE(fs::exists(scans / "states_000.ply"));
}

TEST_F(Outputs, WithoutAFolderToLieInAreRefusedAtOnce) {
  const std::string nowhere = beside("resluts").string();
  for (const Arguments& arguments :
       {Arguments{"analyze", mesh(), "-o", nowhere + "/w.json"},
        {"analyze", mesh(), "-o", beside("w.json"), "--mesh-out", nowhere + "/m.ply"},
        {"mesh", "convert", mesh(), nowhere + "/m.stl"},
        {"plan", session(), "-o", nowhere + "/red_map.json"},
        {"pins", "--size", "50x40x20", "-o", nowhere + "/pins.png"}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("there is no folder " + nowhere));
    EXPECT_FALSE(fs::exists(nowhere));
  }
}

TEST_F(Outputs, OfANameThatTellsNoFormatAreRefusedBeforeTheWork) {
  for (const Arguments& arguments :
       {Arguments{"stitch", session(), "-o", beside("m.foo")},
        {"analyze", mesh(), "-o", beside("w.json"), "--mesh-out", beside("m.foo")}}) {
    const Outcome outcome = run_command(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cannot tell the mesh format from the name"));
    EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("%"))) << "no work was begun";
  }
}

TEST_F(Outputs, AndTheJsonObjectDoNotShareStandardOutput) {
  const Outcome outcome = run_command({"mesh", "convert", mesh(), beside("m.ply"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Outcome mixed = run_command({"analyze", mesh(), "-o", "/dev/stdout", "--json"});
  EXPECT_EQ(mixed.status, 2) << mixed.err;
  EXPECT_TRUE(mixed.json().contains("error")) << mixed.out;
  EXPECT_THAT(mixed.err, HasSubstr("--json prints its object there"));
}

TEST_F(Outputs, GoBesideASessionAsBefore) {
  const Outcome converted = run_command({"mesh", "convert", mesh(), beside("tablet-model.stl")});
  EXPECT_EQ(converted.status, 0) << converted.err;
  EXPECT_TRUE(fs::is_regular_file(beside("tablet-model.stl")));
}

}  // namespace
}  // namespace dubsar
