// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar wedges correct: noted beside the wedges, made by every analysis after, and taken back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "acquisition/session_store.h"
#include "formats/corrections_json.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "formats/wedges_json.h"
#include "tests/acquisition/session_support.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// The deepest first: these are measured as well where a person points at them.
std::vector<Wedge> by_depth(std::vector<Wedge> wedges) {
  std::ranges::sort(wedges, std::greater(), &Wedge::depth_mm);
  return wedges;
}

class Correct : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    run_command({"simulate", "tablet", "--seed", "3", "--size", "16x14x8", "--spacing", "0.1", "-o",
                 folder_->path().string()});
    run_command({"analyze", in("tablet.ply"), "-o", in("w.json")});
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::string in(const std::string& name) { return (folder_->path() / name).string(); }
  static Outcome correct(std::vector<std::string> what) {
    std::vector<std::string> all{"wedges", "correct", in("tablet.ply"), "-o", in("w.json")};
    all.insert(all.end(), what.begin(), what.end());
    return run_command(all);
  }
  static WedgeFile wedges() { return *read_wedges(in("w.json")); }
  /// Without the times.
  static std::string bytes() {
    WedgeFile file = wedges();
    file.timings_s.clear();
    return wedges_to_json(file);
  }

  static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* Correct::folder_ = nullptr;

TEST_F(Correct, ADeletedWedgeStaysDeletedUntilItIsTakenBack) {
  const std::string before = bytes();
  const std::size_t count = wedges().wedges.size();
  ASSERT_GT(count, 8U);
  const Outcome deleted = correct({"--delete", "3,6"});
  ASSERT_EQ(deleted.status, 0) << deleted.err;
  EXPECT_THAT(wedges().wedges, SizeIs(count - 2));
  EXPECT_EQ(wedges().wedges[3].id, 4);
  EXPECT_EQ(wedges().corrections, 1U);
  // The analysis goes by it, and knows what it has done.
  EXPECT_THAT(run_command({"analyze", in("tablet.ply"), "-o", in("w.json")}).out, HasSubstr("done before"));
  ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", in("w.json"), "--again"}).status, 0);
  EXPECT_THAT(wedges().wedges, SizeIs(count - 2));
  const Outcome listed = correct({"--list", "--json"});
  EXPECT_EQ(listed.json()["corrections"][0]["do"], "delete");
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--list", "--delete", "3"},
                                             {"--undo", "--delete", "3"},
                                             {"--undo", "--list"},
                                             {"--delete", "3", "--into", "1,2,3"},
                                             {"--delete", "3", "--reach", "2"}}) {
    const Outcome both = correct(more);
    EXPECT_EQ(both.status, 2) << "no part passes unheard";
    EXPECT_THAT(both.complaints(), SizeIs(1)) << both.err;
  }
  EXPECT_EQ(wedges().corrections, 1U);
  ASSERT_EQ(correct({"--undo"}).status, 0);
  EXPECT_EQ(bytes(), before);
  EXPECT_EQ(correct({"--undo"}).status, 2) << "nothing is left to take back";
}

TEST_F(Correct, KeepsWhatTheAnalysisWasAskedForAndItsDrawings) {
  const auto at = [](const char* name) { return in(std::string("kept/") + name); };
  std::filesystem::create_directory(in("kept"));
  ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", at("w.json"), "--exit", "extent", "--svg",
                         at("svg"), "--fault-reach", "3"})
                .status,
            0);
  const auto drawn = [&](int id) {
    const std::string group = "id=\"wedge-" + std::to_string(id) + "\"";
    return std::ranges::any_of(std::filesystem::directory_iterator(at("svg")), [&](const auto& file) {
      return test::bytes_of(file.path()).find(group) != std::string::npos;
    });
  };
  ASSERT_TRUE(drawn(3));
  const Outcome corrected =
      run_command({"wedges", "correct", in("tablet.ply"), "-o", at("w.json"), "--delete", "3"});
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  EXPECT_EQ(read_wedges(at("w.json"))->exits, ExitDefinition::kExtent);
  EXPECT_FALSE(drawn(3));
  EXPECT_TRUE(drawn(4));
  EXPECT_THAT(run_command({"analyze", in("tablet.ply"), "-o", at("w.json"), "--exit", "extent", "--svg",
                           at("svg"), "--fault-reach", "3"})
                  .out,
              HasSubstr("done before"));
  // What is said now goes before what was said then; without a stamp the file tells.
  ASSERT_EQ(
      run_command({"wedges", "correct", in("tablet.ply"), "-o", at("w.json"), "--undo", "--exit", "surface"})
          .status,
      0);
  EXPECT_EQ(read_wedges(at("w.json"))->exits, ExitDefinition::kSurface);
  EXPECT_TRUE(drawn(3));
  ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", at("w.json"), "--exit", "extent"}).status, 0);
  std::filesystem::remove(at("w.json.done"));
  ASSERT_EQ(run_command({"wedges", "correct", in("tablet.ply"), "-o", at("w.json"), "--delete", "4"}).status,
            0);
  EXPECT_EQ(read_wedges(at("w.json"))->exits, ExitDefinition::kExtent);
}

TEST_F(Correct, OneThatTheDiskRefusedHalfwayIsMadeWhenItIsAskedForAgain) {
  const std::string before = bytes();
  const std::size_t count = wedges().wedges.size();
  // Room for what is noted, none for what is measured.
  const Outcome refused = run_command(
      {"wedges", "correct", in("tablet.ply"), "-o", in("w.json"), "--delete", "3"}, {.largest_file = 4096});
  EXPECT_EQ(refused.status, 4) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("the correction is noted: `dubsar analyze`"));
  EXPECT_EQ(bytes(), before);
  const Outcome again = correct({"--delete", "3"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(wedges().wedges, SizeIs(count - 1));
  EXPECT_THAT(correct({"--list", "--json"}).json()["corrections"], SizeIs(1));
  ASSERT_EQ(correct({"--undo"}).status, 0);
  EXPECT_EQ(bytes(), before);
}

TEST_F(Correct, AnUndoThatTheDiskRefusedHalfwayTakesBackNoSecondOneWhenItIsAskedForAgain) {
  const std::string before = bytes();
  ASSERT_EQ(correct({"--delete", "3"}).status, 0);
  const std::string with_one = bytes();
  // Room for what is noted, none for the wedges or for what is drawn beside them.
  const auto undo = [](const test::CommandOptions& options, const std::vector<std::string>& beside) {
    std::vector<std::string> words{"wedges", "correct", in("tablet.ply"), "-o", in("w.json"), "--undo"};
    words.insert(words.end(), beside.begin(), beside.end());
    return run_command(words, options);
  };
  for (const std::vector<std::string>& beside :
       {std::vector<std::string>{}, {"--mesh-out", in("coloured.ply")}}) {
    ASSERT_EQ(correct({"--delete", "6"}).status, 0);
    const Outcome refused = undo({.largest_file = 4096}, beside);
    EXPECT_EQ(refused.status, 4) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("the correction is taken back: `dubsar analyze`"));
    EXPECT_EQ(wedges().corrections, 2U);
    ASSERT_EQ(undo({}, beside).status, 0);
    EXPECT_THAT(correct({"--list", "--json"}).json()["corrections"], SizeIs(1));
    EXPECT_EQ(bytes(), with_one);
  }
  ASSERT_EQ(correct({"--undo"}).status, 0);
  EXPECT_EQ(bytes(), before);
}

TEST_F(Correct, WhatCannotBeMadeIsOneLineAndChangesNothing) {
  const std::string before = bytes();
  const auto refused = [&](const std::vector<std::string>& what, const std::string& why) {
    const Outcome outcome = correct(what);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.complaints().front(), HasSubstr(why));
  };
  refused({"--delete", "99999"}, "no wedge 99999");
  refused({"--merge", "2"}, "nothing to merge");
  refused({"--split", "2"}, "two wedges or more");
  refused({"--delete", "1", "--merge", "2,3"}, "only one thing is said at a time");
  refused({}, "not said what is to be corrected");
  refused({"--add-at", "1,2,3"}, "how far");
  refused({"--add-at", "nan,2,3", "--reach", "1"}, "no place");
  refused({"--add", "nothing"}, "no selection");
  refused({"--add-at", "500,0,0", "--reach", "1"}, "too few vertices");
  for (const std::vector<std::string>& what :
       {std::vector<std::string>{}, {"--list"}, {"--undo"}, {"--delete", "1", "--merge", "2,3"}}) {
    std::vector<std::string> words{"wedges", "correct", in("tablt.ply"), "-o", in("w.json")};
    words.insert(words.end(), what.begin(), what.end());
    const Outcome mistyped = run_command(words);
    EXPECT_EQ(mistyped.status, 2);
    ASSERT_THAT(mistyped.complaints(), SizeIs(1)) << mistyped.err;
    EXPECT_THAT(mistyped.complaints().front(), HasSubstr("tablt.ply: cannot read: No such file"));
  }
  const Outcome too_soon =
      run_command({"wedges", "correct", in("tablet.ply"), "-o", in("not_yet.json"), "--delete", "1"});
  EXPECT_EQ(too_soon.status, 2);
  EXPECT_THAT(too_soon.err, HasSubstr("dubsar analyze"));
  EXPECT_EQ(bytes(), before);
  EXPECT_FALSE(std::filesystem::exists(corrections_file_of(in("w.json"))) &&
               !read_corrections(corrections_file_of(in("w.json")))->corrections.empty());
}

TEST_F(Correct, WedgesOfAnotherMeshAreNotThisOnes) {
  const std::string before = bytes();
  std::filesystem::copy_file(in("tablet.ply"), in("neighbour.ply"));
  for (const std::vector<std::string>& what :
       {std::vector<std::string>{"--delete", "3"}, {"--undo"}, {"--add-at", "0,0,5", "--reach", "1"}}) {
    std::vector<std::string> words{"wedges", "correct", in("neighbour.ply"), "-o", in("w.json")};
    words.insert(words.end(), what.begin(), what.end());
    const Outcome refused = run_command(words);
    EXPECT_EQ(refused.status, 2) << refused.err;
    ASSERT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
    EXPECT_THAT(refused.complaints().front(),
                HasSubstr("these wedges are of tablet.ply, not of neighbour.ply"));
  }
  EXPECT_EQ(bytes(), before);
  // An analysis may be meant: a mesh cleaned anew has another name.
  CorrectionFile said{"tablet.ply",
                      {{CorrectionKind::kDelete, {wedges().wedges[3].depth_point_mm}, {}, {}, 0}}};
  ASSERT_TRUE(write_corrections(corrections_file_of(in("n.json")), said));
  const Outcome outcome = run_command({"analyze", in("neighbour.ply"), "-o", in("n.json")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("were made on tablet.ply and are made on neighbour.ply"));
  EXPECT_EQ(read_wedges(in("n.json"))->corrections, 1U);
}

TEST_F(Correct, OnesThatLieElsewhereDoNotPassOutOfTheWedges) {
  const CorrectionFile said{"tablet.ply",
                            {{CorrectionKind::kDelete, {wedges().wedges[3].depth_point_mm}, {}, {}, 0}}};
  ASSERT_TRUE(write_corrections(in("said.json"), said));
  const std::string out = in("said_elsewhere.json");
  ASSERT_EQ(run_command({"analyze", in("tablet.ply"), "-o", out, "--corrections", in("said.json")}).status,
            0);
  const std::string before = test::bytes_of(out);
  const std::string id = std::to_string(read_wedges(out)->wedges[4].id);
  for (const std::vector<std::string>& what : {std::vector<std::string>{"--delete", id}, {"--undo"}}) {
    std::vector<std::string> words{"wedges", "correct", in("tablet.ply"), "-o", out};
    words.insert(words.end(), what.begin(), what.end());
    const Outcome refused = run_command(words);
    EXPECT_EQ(refused.status, 2) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("said_elsewhere.corrections.json is not there; name the file"));
    EXPECT_EQ(test::bytes_of(out), before);
  }
  const Outcome named = run_command(
      {"wedges", "correct", in("tablet.ply"), "-o", out, "--corrections", in("said.json"), "--delete", id});
  EXPECT_EQ(named.status, 0) << named.err;
  EXPECT_EQ(read_wedges(out)->corrections, 2U);
}

/// The workflows analyse a mesh that was stitched beside its session, with what was said in the session.
TEST_F(Correct, OnesOfASessionAreNotOfAnotherMeshBesideIt) {
  const auto make_session = [](const std::string& name) {
    SessionStore store = SessionStore::open_or_create(in(name)).value();
    EXPECT_TRUE(store.add_grid(test::small_grid(1)));
    const CorrectionFile said{"model.ply",
                              {{CorrectionKind::kDelete, {wedges().wedges[3].depth_point_mm}, {}, {}, 0}}};
    EXPECT_TRUE(write_corrections(in(name + "/analysis/wedges.corrections.json"), said));
  };
  make_session("S");
  make_session("T");
  for (const char* folder : {"S.results", "elsewhere"}) {
    std::filesystem::create_directory(in(folder));
    std::filesystem::copy_file(in("tablet.ply"), in(folder + std::string("/mesh.ply")));
  }
  // As `dubsar stitch` writes the mesh of a session that has no museum number.
  Mesh mesh = read_mesh(in("tablet.ply")).value();
  ASSERT_TRUE(write_mesh(in("elsewhere/of_s.ply"), mesh, label_of_words({{"Session", "S"}})));
  const auto said_of = [](const std::string& file, const std::string& session) {
    const Outcome outcome = run_command({"analyze", in(file), "-o", in("beside.json"), "--again",
                                         "--corrections", in(session + "/analysis/wedges.corrections.json")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read_wedges(in("beside.json"))->corrections, 1U);
    return outcome.err;
  };
  for (const char* file : {"S.results/mesh.ply", "elsewhere/of_s.ply"}) {
    EXPECT_THAT(said_of(file, "S"), ::testing::Not(HasSubstr("were made on"))) << file;
    EXPECT_THAT(said_of(file, "T"), HasSubstr("were made on model.ply and are made on")) << file;
  }
  EXPECT_THAT(said_of("elsewhere/mesh.ply", "S"),
              HasSubstr("were made on model.ply and are made on mesh.ply"));
}

TEST_F(Correct, WhatIsAddedIsMarkedInEveryList) {
  const Wedge first = by_depth(wedges().wedges)[2];
  ASSERT_EQ(correct({"--delete", std::to_string(first.id)}).status, 0);
  const Eigen::Vector3d& at = first.depth_point_mm;
  const Outcome added = correct(
      {"--add-at", std::to_string(at.x()) + "," + std::to_string(at.y()) + "," + std::to_string(at.z()),
       "--reach", "1.2"});
  ASSERT_EQ(added.status, 0) << added.err;
  const Wedge last = wedges().wedges.back();
  EXPECT_EQ(last.by_hand, ByHand::kAdded);
  EXPECT_LT((last.depth_point_mm - at).norm(), 0.1);
  ASSERT_EQ(correct({"--undo"}).status, 0);
  ASSERT_EQ(correct({"--undo"}).status, 0);
}

/// What is cited by an id is that wedge, whatever is measured after.
TEST_F(Correct, IdsStayWithTheirWedgesAndAreGivenToNoOther) {
  const std::string out = in("cited.json");
  const std::vector<std::string> analyze{"analyze", in("tablet.ply"), "-o", out, "--again"};
  ASSERT_EQ(run_command(analyze).status, 0);
  const WedgeFile from_nothing = *read_wedges(out);
  ASSERT_GT(from_nothing.wedges.size(), 8U);
  // As if it had been measured on another mesh, where 2 was not seen and others were.
  WedgeFile cited = from_nothing;
  cited.wedges.erase(cited.wedges.begin() + 2);
  for (Wedge& wedge : cited.wedges) {
    wedge.id = 300 - wedge.id;
  }
  cited.former = {{400, {400, 0, 0}, ByHand::kNo}};
  ASSERT_TRUE(write_wedges(out, cited));
  const auto expect_cited = [&](int without) {
    const WedgeFile now = *read_wedges(out);
    for (const Wedge& wedge : cited.wedges) {
      const auto same = std::ranges::find(now.wedges, wedge.id, &Wedge::id);
      EXPECT_EQ(same == now.wedges.end(), wedge.id == without) << wedge.id;
      EXPECT_TRUE(same == now.wedges.end() || same->depth_point_mm == wedge.depth_point_mm) << wedge.id;
    }
    return now;
  };
  const Outcome outcome = run_command(analyze);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("known before")));
  const WedgeFile now = expect_cited(-1);
  EXPECT_EQ(now.wedges.back().id, 401);
  EXPECT_EQ(now.wedges.back().depth_point_mm, from_nothing.wedges[2].depth_point_mm);
  ASSERT_THAT(now.former, SizeIs(1));
  // One that is taken back leaves its id to no other; one that was deleted has its own again.
  const auto say = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"wedges", "correct", in("tablet.ply"), "-o", out});
    const Outcome said = run_command(words);
    EXPECT_EQ(said.status, 0) << said.err;
  };
  say({"--delete", "295"});
  EXPECT_THAT(expect_cited(295).former, SizeIs(2));
  say({"--undo"});
  EXPECT_THAT(expect_cited(-1).former, SizeIs(1));
  const auto added_for = [&](int id) {  // whatever is measured there: it gets an id
    const WedgeFile file = *read_wedges(out);
    const Wedge& wedge = *std::ranges::find(file.wedges, id, &Wedge::id);
    const Eigen::Vector3d& at = wedge.depth_point_mm;
    say({"--delete", std::to_string(id)});
    say({"--add-at", std::to_string(at.x()) + "," + std::to_string(at.y()) + "," + std::to_string(at.z()),
         "--reach", "1.2"});
    const int added = read_wedges(out)->wedges.back().id;
    say({"--undo"});
    say({"--undo"});
    return added;
  };
  cited.wedges = by_depth(cited.wedges);
  EXPECT_EQ(added_for(cited.wedges[2].id), 402);
  EXPECT_EQ(added_for(cited.wedges[2].id), 402) << "the same wedge again";
  EXPECT_EQ(added_for(cited.wedges[3].id), 403);
  EXPECT_THAT(expect_cited(-1).former, SizeIs(3));
  // A tablet that lies elsewhere in its file has no wedge under the id of another.
  Mesh mesh = *read_mesh(in("tablet.ply"));
  const auto analyze_moved = [&](const char* name) {
    for (Eigen::Vector3f& p : mesh.positions) {
      p.z() += 30;
    }
    std::filesystem::create_directory(in("there"));
    EXPECT_TRUE(write_mesh(in(name), mesh));
    return run_command({"analyze", in(name), "-o", out}).err;
  };
  EXPECT_THAT(analyze_moved("there/tablet.ply"), HasSubstr("the others have new ids"));
  EXPECT_GT(read_wedges(out)->wedges.front().id, 403);
  // Another one counts from 0.
  EXPECT_THAT(analyze_moved("there/other.ply"), HasSubstr("all ids are given anew"));
  EXPECT_EQ(read_wedges(out)->wedges.front().id, 0);
  EXPECT_THAT(read_wedges(out)->former, SizeIs(0));
}

TEST_F(Correct, ACorrectionThatLostItsPlaceIsAWarning) {
  CorrectionFile said;
  said.corrections.push_back({CorrectionKind::kDelete, {{500, 0, 0}}, {}, {}, 0});
  ASSERT_TRUE(write_corrections(corrections_file_of(in("lost.json")), said));
  const Outcome outcome = run_command({"analyze", in("tablet.ply"), "-o", in("lost.json")});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("correction 1 is not made"));
  EXPECT_THAT(read_wedges(in("lost.json"))->lost, SizeIs(1));
  std::ofstream(in("bad.corrections.json")) << R"({"corrections":[{"do":"split","at":[[0,0,0]]}]})";
  EXPECT_EQ(run_command({"analyze", in("tablet.ply"), "-o", in("bad.json")}).status, 2);
}

}  // namespace
}  // namespace dubsar
