// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the command answers to words that it cannot act on, and the made-up tablets and scans.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "build_paths.h"
#include "formats/atomic_file.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "formats/wedges_json.h"
#include "tests/station/support/command.h"
#include "tests/station/support/shell.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(CommandUsage, AnAnswerThatCouldNotBePrintedIsNoSuccess) {
  const test::TemporaryFolder folder;
  const fs::path err = folder.path() / "err";
  const int status =
      test::shell("{ " DUBSAR_BINARY_DIR "/bin/dubsar drivers --json >/dev/full; } 2>" + test::quoted(err));
  EXPECT_EQ(status, 4);
  EXPECT_THAT(test::bytes_of(err), HasSubstr("dubsar: standard output: it did not take all of the answer"));
}

TEST(CommandUsage, AReaderThatHasWhatItWantsIsNoFault) {
  const test::TemporaryFolder folder;
  const fs::path err = folder.path() / "err";
  // The reader of the pipe is gone before anything is written.
  const int status =
      test::shell("bash -c 'exec 3> >(:); wait $!; " DUBSAR_BINARY_DIR "/bin/dubsar drivers --json >&3' 2>" +
                  test::quoted(err));
  EXPECT_EQ(status, 0);
  EXPECT_EQ(test::bytes_of(err), "");
}

TEST(CommandUsage, ATabletOfTheWrongUnitIsNotScannedUntilTheMemoryIsFull) {
  const test::TemporaryFolder folder;
  const std::string made = (folder.path() / "made").string();
  ASSERT_EQ(run_command({"simulate", "tablet", "--size", "24x20x10", "--spacing", "1", "-o", made}).status,
            0);
  const auto scans = [&](const char* unit) {
    return run_command({"simulate", "scans", "--tablet", made + "/tablet.ply", "--unit", unit, "--views", "1",
                        "--spacing", "1", "-o", made});
  };
  const Outcome wrong = scans("m");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("mm across: at a spacing of 1 mm a scan would have"));
  EXPECT_THAT(wrong.err, HasSubstr("--unit"));
  EXPECT_EQ(scans("mm").status, 0);
}

TEST(CommandUsage, WrongWordsAreStatusTwoAndOneLine) {
  const test::TemporaryFolder folder;
  const std::string session = (folder.path() / "session").string();
  const std::vector<Arguments> wrong{
      {},
      {"frobnicate"},
      {"plan"},
      {"plan", session},
      {"plan", "--frob", session},
      {"verify", session},
      {"verify", folder.path().string()},
      {"verify", DUBSAR_SOURCE_DIR "/README.md"},
      {"simulate", "tablet", "--size", "24x20", "-o", session},
      {"simulate", "tablet", "--size", "0x20x10", "-o", session},
      {"simulate", "tablet", "--spacing", "nan", "-o", session},
      {"simulate", "scans", "--tablet", session, "-o", session},
      {"scan"},
      {"scan", "--device", "", "--session", session},
      {"scan", "--device", "nonsense:x", "--session", session},
      {"scan", "--device", "replay:" + session + "/nowhere", "--session", session},
      {"scan", "--device", "sim:?sed=1", "--session", session},
      {"scan", "--device", "sim:?size=24x20", "--session", session},
      {"scan", "--device", "sim:", "--max-scans", "0", "--session", session},
      {"scan", "--device", "sim:", "--pins", session, "--session", session},
      {"mesh", "check", session},
      {"stitch", folder.path().string()},
  };
  for (Arguments words : wrong) {
    const std::string said = ::testing::PrintToString(words);
    const Outcome plain = run_command(words);
    EXPECT_EQ(plain.status, 2) << said << plain.err;
    EXPECT_EQ(std::count(plain.err.begin(), plain.err.end(), '\n'), 1) << said << plain.err;
    EXPECT_EQ(plain.out, "") << said;
    words.emplace_back("--json");
    const Outcome json = run_command(words);
    EXPECT_EQ(json.status, 2) << said;
    ASSERT_TRUE(json.json().is_object()) << said << json.out;
    EXPECT_FALSE(json.json()["error"]["what"].get<std::string>().empty()) << said;
  }
  EXPECT_FALSE(fs::exists(session)) << "a wrong word must leave nothing behind";
}

TEST(CommandUsage, AVerbThatIsMistypedOrMissingIsAnsweredWithThoseThatThereAre) {
  const std::vector<std::pair<Arguments, const char*>> said{
      {{"analyse", "m.ply", "-o", "w.json"}, "there is no verb analyse; do you mean analyze?"},
      {{"mesh", "chek", "m.ply"}, "mesh: there is no verb chek; do you mean check?"},
      {{"session", "remove", "s"}, "session: there is no verb remove; there are: list, undo, drop"},
      {{""}, "a verb is missing; there are: drivers, "},
      {{"session", ""}, "session: a verb is missing; there are: list, "},
      {{"mesh"}, "mesh: a verb is missing; there are: check, convert, section, part"},
      {{},
       "a verb is missing; there are: drivers, simulate, calibrate, scan, register, plan, pins, stitch, "
       "analyze, wedges, search, mesh, export, verify, session, view, station, bench\n"}};
  for (const auto& [words, answer] : said) {
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(answer));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST(CommandUsage, AnOptionThatIsMistypedIsAnsweredWithTheOneThatIsMeant) {
  const std::vector<std::pair<Arguments, const char*>> said{
      {{"register", "s", "--unti", "m"}, "dubsar register: there is no option --unti; do you mean --unit?"},
      {{"register", "s", "--unti=m"}, "dubsar register: there is no option --unti; do you mean --unit?"},
      {{"mesh", "check", "m.ply", "--jsn"},
       "dubsar mesh check: there is no option --jsn; do you mean --json?"},
      {{"stitch", "s", "--outt", "m.ply"}, "dubsar stitch: there is no option --outt; do you mean --out?"},
      {{"plan", "--frobnicate", "s"}, "dubsar plan: there is no option --frobnicate; see dubsar plan --help"},
      {{"register", "s", "t", "u"}, "dubsar register: nothing is known of: t u; see dubsar register --help"}};
  for (const auto& [words, answer] : said) {
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(answer));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST(CommandUsage, AnEmptyTextIsNoNameAndNoPlace) {
  const std::vector<std::pair<Arguments, const char*>> said{
      {{"export", "s", "--to", ""}, "--to: nothing is said"},
      {{"analyze", "m.ply", "-o", ""}, "--out: nothing is said"},
      {{"stitch", "s", "-o", ""}, "--out: nothing is said"},
      {{"search", "s", "--like=", "--count", "3"}, "--like: nothing is said"},
      {{"stitch", "s", "-o", "m.ply", "--poses="}, "--poses: nothing is said"},
      {{"verify", ""}, "path: nothing is said"},
      {{"mesh", "convert", "m.ply", ""}, "out: nothing is said"}};
  for (const auto& [words, answer] : said) {
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(answer));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST(CommandUsage, ANumberBelowZeroIsRefusedInAFewWords) {
  const std::string mesh = DUBSAR_SOURCE_DIR "/tests/data/sessions/schema1_first/mesh/model.ply";
  const std::vector<Arguments> counted{
      {"simulate", "tablet", "-o", "x", "--seed"},
      {"simulate", "scans", "--tablet", mesh, "-o", "x", "--seed"},
      {"simulate", "rig", "-o", "x", "--seed"},
      {"search", ".", "--like", "w.json", "--wedge"},
      {"wedges", "correct", mesh, "-o", "x.json", "--into", "0,0,0", "--split"},
      {"session", "hint", "s", "0", "--pose", "p.json", "--on"},
  };
  for (Arguments words : counted) {
    words.emplace_back("-1");
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("'-1' is below 0; see dubsar --help, or dubsar VERB --help\n"));
  }
}

TEST(CommandUsage, AFolderIsNoScriptAndNoOutput) {
  const test::TemporaryFolder folder;
  const std::string here = folder.path().string();
  const std::string mesh = DUBSAR_SOURCE_DIR "/tests/data/sessions/schema1_first/mesh/model.ply";
  const std::vector<Arguments> wrong{
      {"station", "--session", here + "/s", "--script", here},
      {"view", mesh, "--script", here},
      {"analyze", mesh, "-o", here},
  };
  for (const Arguments& words : wrong) {
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("dubsar: " + here + ": "));
    EXPECT_THAT(outcome.err, HasSubstr("name a file"));
  }
}

TEST(CommandUsage, APictureOfPinsIsAPng) {
  EXPECT_THAT(run_command({"pins", "--size", "50x40x20", "-o", "x.gif"}).err,
              HasSubstr("does not end in .png"));
}

/// A rough mesh from another program, in centimetres.
TEST(CommandUsage, PinsAreNotPutRoundATabletOfTheWrongUnit) {
  const test::TemporaryFolder folder;
  const std::string mesh = (folder.path() / "rough.obj").string();
  ASSERT_TRUE(write_file_atomically(mesh,
                                    "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 0 2 0\nv 0 0 1\nv 3 0 1\nv 3 2 1\nv 0 2 1\n"
                                    "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
                                    "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n"));
  const Outcome unsaid = run_command({"pins", "--mesh", mesh, "--count", "3", "--json"});
  EXPECT_EQ(unsaid.status, 2) << unsaid.out;
  EXPECT_THAT(unsaid.err, HasSubstr("say what its numbers are: repeat it with --unit"));
  const Outcome said = run_command({"pins", "--mesh", mesh, "--unit", "cm", "--count", "3", "--json"});
  ASSERT_EQ(said.status, 0) << said.err;
  std::vector<double> sides = said.json()["size_mm"].get<std::vector<double>>();
  std::ranges::sort(sides);
  ASSERT_THAT(sides, SizeIs(3));
  EXPECT_NEAR(sides[0], 10, 0.1);
  EXPECT_NEAR(sides[2], 30, 0.1);
  EXPECT_FALSE(said.json().contains("unit_assumed"));
}

TEST(CommandUsage, WhatIsNoNumberPassesNoLimit) {
  const std::string mesh = DUBSAR_SOURCE_DIR "/tests/data/sessions/schema1_first/mesh/model.ply";
  const std::vector<Arguments> limited{
      {"simulate", "tablet", "-o", "x", "--damage"},
      {"simulate", "scans", "--tablet", mesh, "-o", "x", "--spacing"},
      {"analyze", mesh, "-o", "x.json", "--free-openness"},
      {"analyze", mesh, "-o", "x.json", "--invariant-radius"},
      {"wedges", "correct", mesh, "-o", "x.json", "--add-at", "0,0,0", "--reach"},
      {"pins", "--mesh", mesh, "-o", "x.png", "--triangulation"},
      {"simulate", "rig", "-o", "x", "--laser-sigma"},
  };
  for (const Arguments& words : limited) {
    for (const char* number : {"nan", "-nan", "NAN", "inf"}) {
      Arguments all = words;
      all.back() += std::string("=") + number;
      const Outcome refused = run_command(all);
      EXPECT_EQ(refused.status, 2) << ::testing::PrintToString(all);
      EXPECT_THAT(refused.err, HasSubstr("is no number")) << ::testing::PrintToString(all) << refused.err;
    }
  }
}

TEST(CommandUsage, ACountIsAWholeNumber) {
  const Outcome refused = run_command({"search", "x", "--like", "x.json", "--count", "5.5"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--count: '5.5' is no whole number"));
}

TEST(CommandUsage, ASearchThatFindsOnlyCopiesSaysSo) {
  const test::TemporaryFolder folder;
  WedgeFile file;
  for (int i = 0; i < 12; ++i) {
    const double x = 3.0 * i;
    Wedge wedge;
    wedge.id = i;
    wedge.depth_mm = 0.5;
    wedge.depth_point_mm = {x, 0, -0.5};
    wedge.exit_points_mm = {Eigen::Vector3d(x + 2, 0, 0), Eigen::Vector3d(x - 0.3, 0.5, 0),
                            Eigen::Vector3d(x - 0.3, -0.5 - 0.01 * i, 0)};
    file.wedges.push_back(wedge);
  }
  const std::string like = (folder.path() / "a.json").string();
  ASSERT_TRUE(write_wedges(like, file));
  ASSERT_TRUE(write_wedges(folder.path() / "b.json", file));
  const Outcome found = run_command({"search", folder.path().string(), "--like", like});
  EXPECT_EQ(found.status, 0) << found.err;
  EXPECT_EQ(found.out, "");
  EXPECT_THAT(found.err, HasSubstr("there is no other tablet to compare it with"));
}

TEST(CommandUsage, HelpIsStatusZero) {
  for (const Arguments& words : std::vector<Arguments>{{"--help"}, {"scan", "--help"}, {"--version"}}) {
    const Outcome asked = run_command(words);
    EXPECT_EQ(asked.status, 0);
    EXPECT_FALSE(asked.out.empty());
    EXPECT_EQ(asked.err, "");
  }
}

TEST(CommandUsage, DriversListsWhatIsThere) {
  const nlohmann::json json = run_command({"drivers", "--json"}).json();
  ASSERT_TRUE(json.is_object());
  std::vector<std::string> schemes;
  for (const auto& driver : json["drivers"]) {
    schemes.push_back(driver["scheme"]);
  }
  EXPECT_THAT(schemes, ::testing::IsSupersetOf({"replay", "sim"}));
}

TEST(CommandUsage, DriversSaysWhatAnOptionMayBe) {
  const std::string said = run_command({"drivers"}).out;
  EXPECT_THAT(said, HasSubstr("?spacing=  lateral spacing of the samples; default: 0.1 (mm; 0.01 to 5)\n"));
  EXPECT_THAT(said, HasSubstr("?motion=  what is driven; default: turntable (turntable|robot)\n"));
  EXPECT_THAT(said, HasSubstr("?size=  of the tablet, WxHxT, each 5 to 300; default: 50x40x20 (mm)\n"));
}

TEST(CommandSimulate, TheSameSeedGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const auto tablet = [&](const char* name, const char* seed) {
    const fs::path made = folder.path() / name;
    EXPECT_EQ(run_command({"simulate", "tablet", "--seed", seed, "--size", "24x20x10", "--spacing", "0.25",
                           "-o", made.string()})
                  .status,
              0);
    return made;
  };
  const fs::path first = tablet("a", "3");
  const fs::path again = tablet("b", "3");
  const fs::path other = tablet("c", "4");
  EXPECT_EQ(run_command({"mesh", "check", (first / "tablet.ply").string()}).status, 0);
  for (const char* file : {"tablet.ply", "truth.json"}) {
    EXPECT_FALSE(test::bytes_of(first / file).empty());
    EXPECT_TRUE(test::bytes_of(first / file) == test::bytes_of(again / file)) << file;
    EXPECT_FALSE(test::bytes_of(first / file) == test::bytes_of(other / file)) << file;
  }

  const auto scans = [&](const char* name) {
    const fs::path made = folder.path() / name;
    EXPECT_EQ(run_command({"simulate", "scans", "--tablet", (first / "tablet.ply").string(), "--views", "6",
                           "--spacing", "0.25", "--pins", "-o", made.string()})
                  .status,
              0);
    return made;
  };
  const fs::path one = scans("one");
  const fs::path two = scans("two");
  for (const char* file : {"scan_000.ply", "scan_005.ply", "truth_poses.json", "pins.json"}) {
    EXPECT_FALSE(test::bytes_of(one / file).empty()) << file;
    EXPECT_TRUE(test::bytes_of(one / file) == test::bytes_of(two / file)) << file;
  }
  const auto truth = read_poses(one / "truth_poses.json");
  ASSERT_TRUE(truth.has_value());
  EXPECT_THAT(*truth, SizeIs(6));
  EXPECT_TRUE(read_pins(one / "pins.json").has_value());
}

/// They would be registered, stitched and judged with the others as scans of one tablet.
TEST(CommandUsage, ScansOfAnEarlierRunAreNotLeftAmongThoseOfAnother) {
  const test::TemporaryFolder folder;
  const std::string made = (folder.path() / "made").string();
  ASSERT_EQ(run_command({"simulate", "tablet", "--size", "24x20x10", "--spacing", "1", "-o", made}).status,
            0);
  const auto scans = [&](const char* views) {
    return run_command({"simulate", "scans", "--tablet", made + "/tablet.ply", "--views", views, "--spacing",
                        "1", "-o", made});
  };
  ASSERT_EQ(scans("3").status, 0);
  const std::string before = test::bytes_of(folder.path() / "made/scan_000.ply");
  const Outcome fewer = scans("2");
  EXPECT_EQ(fewer.status, 2);
  EXPECT_THAT(fewer.complaints(), SizeIs(1)) << fewer.err;
  EXPECT_THAT(fewer.err, HasSubstr("scan_002.ply"));
  EXPECT_TRUE(test::bytes_of(folder.path() / "made/scan_000.ply") == before);
  EXPECT_EQ(scans("3").status, 0) << "the same again";
  fs::remove(folder.path() / "made/scan_002.ply");
  EXPECT_EQ(scans("2").status, 0);
}

}  // namespace
}  // namespace dubsar
