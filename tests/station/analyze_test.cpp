// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze: from the mesh file to wedges.json, and what it says to meshes that hold none.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/mesh_io.h"
#include "formats/truth_json.h"
#include "formats/wedges_json.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;

TEST(AnalyzeCommand, FindsTheWedgesOfASimulatedTablet) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  ASSERT_EQ(run_command({"simulate", "tablet", "--seed", "3", "--size", "24x20x10", "--spacing", "0.1", "-o",
                         at("t")})
                .status,
            0);
  const Outcome outcome = run_command({"--json", "analyze", at("t/tablet.ply"), "-o", at("wedges.json"),
                                       "--mesh-out", at("annotated.ply"), "--svg", at("svg")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  ASSERT_TRUE(outcome.json().is_object()) << outcome.out;
  const auto file = read_wedges(at("wedges.json"));
  ASSERT_TRUE(file) << file.error().line();
  const auto truth = read_truth(at("t/truth.json"));
  ASSERT_TRUE(truth);
  EXPECT_EQ(outcome.json()["count"], file->wedges.size());
  EXPECT_EQ(file->mesh, "t/tablet.ply") << "from the folder of the file";
  int whole = 0;
  int found = 0;
  for (const Wedge& wedge : truth->wedges) {
    if (wedge.intact < 0.6) {
      continue;
    }
    ++whole;
    found += std::ranges::any_of(
        file->wedges, [&](const Wedge& w) { return (w.depth_point_mm - wedge.depth_point_mm).norm() < 0.2; });
  }
  ASSERT_GT(whole, 30);
  EXPECT_GE(found, 0.9 * whole);
  const auto annotated = read_mesh(at("annotated.ply"));
  ASSERT_TRUE(annotated);
  EXPECT_EQ(annotated->colours.size(), annotated->positions.size());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "svg" / "obverse.svg"));

  // The other exit definition changes the exits, and nothing else.
  ASSERT_EQ(run_command({"analyze", at("t/tablet.ply"), "-o", at("extent.json"), "--exit", "extent"}).status,
            0);
  const auto extent = read_wedges(at("extent.json"));
  ASSERT_TRUE(extent);
  ASSERT_EQ(extent->wedges.size(), file->wedges.size());
  EXPECT_EQ(extent->wedges[0].exit_points_mm, extent->wedges[0].exit_points_extent_mm);
  EXPECT_EQ(file->wedges[0].exit_points_mm, file->wedges[0].exit_points_surface_mm);
  EXPECT_EQ(extent->wedges[0].depth_point_mm, file->wedges[0].depth_point_mm);
}

TEST(SearchCommand, FindsTheLikeAndLeavesOutTheSame) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  // Three "tablets" of one shape of wedge each; b and c are nearly alike.
  const auto write = [&](const char* name, double depth, double length, int count = 12, int method = 0) {
    WedgeFile file;
    file.method = method;
    for (int i = 0; i < count; ++i) {
      Wedge w;
      w.id = i;
      w.depth_point_mm = {3.0 * i, 0, -depth};
      w.exit_points_mm = {Eigen::Vector3d(3.0 * i + length, 0, 0), Eigen::Vector3d(3.0 * i - 0.3, 0.5, 0),
                          Eigen::Vector3d(3.0 * i - 0.3, -0.5 - 0.01 * i, 0)};
      file.wedges.push_back(w);
    }
    ASSERT_TRUE(write_wedges(at(name), file));
  };
  write("a.json", 1.2, 4.0);
  write("b.json", 0.5, 2.0);
  write("c.json", 0.52, 2.05);
  std::ofstream(at("note.json")) << "{}";
  std::ofstream(at("torn.json")) << R"({"unit": "mm", "wedges": [)";
  const Outcome tablets = run_command({"--json", "search", folder.path().string(), "--like", at("b.json")});
  ASSERT_EQ(tablets.status, 0) << tablets.err;
  ASSERT_EQ(tablets.json()["tablets"].size(), 2U) << tablets.out;
  EXPECT_EQ(tablets.json()["tablets"][0]["tablet"], "c.json");
  EXPECT_THAT(tablets.err, HasSubstr("torn.json"));
  EXPECT_THAT(tablets.err, ::testing::Not(HasSubstr("note.json"))) << "it never was a wedges.json";
  const Outcome wedges = run_command(
      {"--json", "search", folder.path().string(), "--like", at("b.json"), "--wedge", "5", "--count", "3"});
  ASSERT_EQ(wedges.status, 0) << wedges.err;
  ASSERT_EQ(wedges.json()["wedges"].size(), 3U);
  EXPECT_EQ(wedges.json()["wedges"][0]["tablet"], "b.json");
  EXPECT_NE(wedges.json()["wedges"][0]["id"], 5);
  EXPECT_EQ(run_command({"search", folder.path().string(), "--like", at("b.json"), "--wedge", "99"}).status,
            2);
  EXPECT_EQ(run_command({"search", at("nowhere"), "--like", at("b.json")}).status, 2);
  EXPECT_EQ(run_command({"search", folder.path().string(), "--like", at("note.json")}).status, 2);
  // Four wedges say nothing of a hand, as four of another tablet do; one of them is looked for.
  write("few.json", 0.5, 2.0, 4);
  std::filesystem::remove(at("torn.json"));
  const Outcome few = run_command({"search", folder.path().string(), "--like", at("few.json")});
  EXPECT_EQ(few.status, 2);
  ASSERT_EQ(few.complaints().size(), 1U) << few.err;
  EXPECT_THAT(few.err, HasSubstr("it has 4 wedges to search by, and tablets are compared from 5 on"));
  EXPECT_EQ(run_command({"search", folder.path().string(), "--like", at("few.json"), "--wedge", "2"}).status,
            0);
  // Wedges that were measured in another way are found, with a word.
  EXPECT_THAT(few.err, ::testing::Not(HasSubstr("in another way")));
  EXPECT_EQ(tablets.json()["of_another_method"], 0);
  write("b.json", 0.5, 2.0, 12, 5);
  const Outcome mixed = run_command({"--json", "search", folder.path().string(), "--like", at("b.json")});
  EXPECT_EQ(mixed.status, 0) << mixed.err;
  EXPECT_EQ(mixed.json()["tablets"].size(), 2U) << mixed.out;
  EXPECT_EQ(mixed.json()["of_another_method"], 3);
  EXPECT_THAT(mixed.err, HasSubstr("3 of 4 tablets that are searched were measured in another way than " +
                                   at("b.json") + " (method 5): a.json for one (a method that is not said)"));
}

TEST(AnalyzeCommand, SaysPlainlyThatThereAreNone) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  std::ofstream(at("ten.obj")) << "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nv 15 15 9\n"
                                  "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
  const Outcome outcome = run_command({"analyze", at("ten.obj"), "-o", at("w.json")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("no wedges"));
  EXPECT_THAT(outcome.err, HasSubstr("too coarse for wedges of the usual size"));
  const Outcome again = run_command({"analyze", at("ten.obj"), "-o", at("w.json")});
  EXPECT_THAT(again.out, HasSubstr("done before"));
  EXPECT_THAT(again.err, HasSubstr("too coarse for wedges of the usual size"));
  const auto file = read_wedges(at("w.json"));
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->wedges.empty());
  EXPECT_GT(file->spacing_mm, 10);
  EXPECT_THAT(file->program, ::testing::StartsWith("Dubsar "));
  EXPECT_GT(file->method, 0);
}

TEST(AnalyzeCommand, TakesTheLikelyUnitAsksForOthersAndRefusesWhatIsNoMesh) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  std::ofstream(at("metres.obj")) << "v 0 0 0\nv .03 0 0\nv .03 .03 0\nv 0 .03 0\nv .015 .015 .009\n"
                                     "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
  const Outcome taken = run_command({"analyze", at("metres.obj"), "-o", at("w.json"), "--json"});
  EXPECT_EQ(taken.status, 0) << taken.err;
  EXPECT_THAT(taken.complaints(), ::testing::SizeIs(2)) << "the other: too coarse for wedges";
  EXPECT_THAT(taken.err,
              HasSubstr("metres.obj: it would be 0.0434 mm across, which nothing inscribed is: its "
                        "numbers are taken for m; confirm that with --unit m (30 x 30 x 9 mm)"));
  EXPECT_EQ(taken.json()["unit_assumed"], "m");
  EXPECT_EQ(read_wedges(at("w.json")).value().unit_assumed, "m");
  EXPECT_EQ(run_command({"analyze", at("metres.obj"), "-o", at("w.json"), "--json"}).json()["unit_assumed"],
            "m")
      << "done before";
  EXPECT_EQ(run_command({"analyze", at("metres.obj"), "-o", at("w.json"), "--unit", "m"}).status, 0);
  EXPECT_EQ(read_wedges(at("w.json")).value().unit_assumed, "");
  std::ofstream(at("small.obj")) << "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1.5 1.5 .9\n"
                                    "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
  const Outcome asked = run_command({"analyze", at("small.obj"), "-o", at("w.json")});
  EXPECT_EQ(asked.status, 2);
  EXPECT_THAT(asked.err, HasSubstr("say what its numbers are: repeat it with --unit cm (30 x 30 x 9 mm), "
                                   "--unit mm (3 x 3 x 0.9 mm) or --unit in (76.2 x 76.2 x 22.9 mm)"));
  EXPECT_EQ(run_command({"analyze", at("metres.obj"), "-o", at("w.json"), "--unit", "cubit"}).status, 2);
  EXPECT_EQ(run_command({"analyze", at("nowhere.ply"), "-o", at("w.json")}).status, 2);
  EXPECT_EQ(run_command({"analyze", at("metres.obj")}).status, 2);
  std::ofstream(at("speck.obj")) << "v 0 0 0\nv 4e-5 0 0\nv 0 3e-5 0\nf 1 2 3\n";
  const Outcome speck = run_command({"analyze", at("speck.obj"), "-o", at("w.json")});
  EXPECT_EQ(speck.status, 2);
  EXPECT_THAT(speck.err, HasSubstr("it would be 5e-05 mm across; nothing inscribed is that small"));
  std::ofstream(at("empty.obj")) << "v 0 0 0\n";
  const Outcome empty = run_command({"analyze", at("empty.obj"), "-o", at("w.json")});
  EXPECT_EQ(empty.status, 2) << empty.err;
}

TEST(AnalyzeCommand, TheUnitThatIsAdvisedIsCountedFromTheOneThatTheFileNames) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  const std::string body =
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 6\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n30 0 0\n30 30 0\n0 30 0\n15 15 9\n"
      "3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n3 0 2 1\n3 0 3 2\n";
  std::ofstream(at("m.ply")) << "ply\nformat ascii 1.0\nobj_info unit m\n" << body;
  const Outcome asked = run_command({"analyze", at("m.ply"), "-o", at("w.json")});
  EXPECT_EQ(asked.status, 2);
  EXPECT_THAT(asked.err,
              HasSubstr("repeat it with --unit cm (300 x 300 x 90 mm), --unit mm (30 x 30 x 9 mm)"));
  EXPECT_EQ(run_command({"analyze", at("m.ply"), "-o", at("w.json"), "--unit", "mm"}).status, 0);
  // glTF is in metres, however its name is written.
  std::ofstream(at("mm.ply")) << "ply\nformat ascii 1.0\n" << body;
  ASSERT_EQ(run_command({"mesh", "convert", at("mm.ply"), at("a.glb"), "--unit", "m"}).status, 0);
  std::filesystem::rename(at("a.glb"), at("A.GLB"));
  const Outcome upper = run_command({"analyze", at("A.GLB"), "-o", at("w.json")});
  EXPECT_EQ(upper.status, 0) << upper.err;
  EXPECT_THAT(upper.err,
              HasSubstr("its numbers are taken for mm; confirm that with --unit mm (30 x 30 x 9 mm), "
                        "or say what they are: --unit cm (300 x 300 x 90 mm) or --unit in (762 x "));
}

}  // namespace
}  // namespace dubsar
