// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar mesh: what it says to meshes that are inside out or have no faces, and to cuts that meet nothing.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <thread>
#include <utility>

#include "formats/mesh_io.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kCorners = "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nv 15 15 9\n";

class MeshCommand : public ::testing::Test {
 protected:
  MeshCommand() {
    std::ofstream(at("tent.obj")) << kCorners << "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
    std::ofstream(at("turned.obj")) << kCorners << "f 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\nf 3 1 2\nf 4 1 3\n";
  }
  [[nodiscard]] std::string at(const char* name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] Outcome cut(const char* mesh, const char* from, const char* to, const char* out) const {
    return run_command({"mesh", "section", at(mesh), "--from", from, "--to", to, "-o", at(out), "--json"});
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(MeshCommand, AMeshThatIsInsideOutIsToldAndTurned) {
  EXPECT_EQ(run_command({"mesh", "check", at("tent.obj"), "--json"}).json()["inside_out"], false);
  const Outcome checked = run_command({"mesh", "check", at("turned.obj"), "--json"});
  EXPECT_EQ(checked.json()["inside_out"], true);
  EXPECT_THAT(checked.err, HasSubstr("its faces look inwards"));

  const Outcome turned = run_command({"mesh", "convert", at("turned.obj"), at("mended.ply"), "--turn-over"});
  EXPECT_EQ(turned.status, 0) << turned.err;
  EXPECT_THAT(turned.complaints(), SizeIs(0)) << turned.err;
  EXPECT_EQ(run_command({"mesh", "check", at("mended.ply"), "--json"}).json()["inside_out"], false);
  EXPECT_THAT(run_command({"mesh", "convert", at("turned.obj"), at("kept.ply")}).err,
              HasSubstr("--turn-over"));
}

TEST_F(MeshCommand, AMeshThatIsRightIsNotTurnedWithoutAWord) {
  const Outcome turned = run_command({"mesh", "convert", at("tent.obj"), at("wrong.ply"), "--turn-over"});
  EXPECT_EQ(turned.status, 0) << turned.err;
  EXPECT_THAT(turned.err, HasSubstr("wrong.ply: its faces looked outwards, and look inwards now; convert it "
                                    "again without --turn-over"));
}

TEST_F(MeshCommand, OfAMeshThatIsInsideOutTheNearSideIsCutAndAnalysed) {
  ASSERT_EQ(cut("tent.obj", "2,15,0", "28,15,0", "right.csv").status, 0);
  const Outcome inside = cut("turned.obj", "2,15,0", "28,15,0", "inside.csv");
  EXPECT_EQ(inside.status, 0) << inside.err;
  EXPECT_THAT(inside.err, HasSubstr("turned over"));
  EXPECT_EQ(inside.json()["highest_mm"], 9.0);
  EXPECT_EQ(bytes_of(at("inside.csv")), bytes_of(at("right.csv")));
  const Outcome analysed =
      run_command({"analyze", at("turned.obj"), "-o", at("w.json"), "--mesh-out", at("out.ply")});
  EXPECT_EQ(analysed.status, 0) << analysed.err;
  EXPECT_THAT(analysed.err, HasSubstr("turned over"));
  EXPECT_EQ(run_command({"mesh", "check", at("out.ply"), "--json"}).json()["inside_out"], false);
}

TEST_F(MeshCommand, APipeThatNobodyReadsIsRefusedAtOnce) {
  ASSERT_EQ(::mkfifo(at("out.ply").c_str(), 0600), 0);
  const Outcome refused = run_command({"mesh", "convert", at("tent.obj"), at("out.ply")});
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_THAT(refused.complaints(),
              ElementsAre(HasSubstr("out.ply: cannot write: a pipe that nobody reads from")));
}

TEST_F(MeshCommand, SigtermEndsItThoughWhoReadsThePipeDoesNot) {
  Mesh large;
  constexpr std::uint32_t kSide = 100;  // as text more than a pipe holds
  for (std::uint32_t v = 0; v < kSide * kSide; ++v) {
    large.positions.emplace_back(static_cast<float>(v % kSide), static_cast<float>(v / kSide), 0.0F);
    if (v % kSide > 0 && v / kSide > 0) {
      large.faces.push_back({v, v - 1, v - kSide});
    }
  }
  ASSERT_TRUE(write_mesh(at("large.ply"), large));
  ASSERT_EQ(::mkfifo(at("out.obj").c_str(), 0600), 0);
  const int reader = ::open(at("out.obj").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  test::RunningCommand running({"mesh", "convert", at("large.ply"), at("out.obj")});
  pollfd begun{reader, POLLIN, 0};
  ASSERT_EQ(::poll(&begun, 1, 240000), 1);
  for (int again = 0; again < 3; ++again) {  // one may come just before it waits
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    running.send(SIGTERM);
  }
  const Outcome stopped = running.wait();
  EXPECT_FALSE(stopped.timed_out);
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_THAT(stopped.complaints(), ElementsAre(HasSubstr("out.obj: writing was stopped"))) << stopped.err;
  ::close(reader);
}

TEST_F(MeshCommand, WhatAFormatCannotHoldIsToldAndNotMadeUpAfterwards) {
  Mesh mesh = read_mesh(at("tent.obj")).value();
  mesh.reliability = {0, 0.25F, 0.5F, 0.75F, 1};
  mesh.flags = {0, 2, 0, 0, 0};
  ASSERT_TRUE(write_mesh(at("tent.ply"), mesh));
  for (const char* name : {"away.obj", "away.stl", "away.glb"}) {
    const Outcome away = run_command({"mesh", "convert", at("tent.ply"), at(name), "--json"});
    EXPECT_EQ(away.json()["vertices"], 5) << away.err;
    EXPECT_THAT(away.complaints(),
                ElementsAre(HasSubstr(" holds no reliability or flags: left out; keep " + at("tent.ply"))))
        << name;
    const Outcome back = run_command({"mesh", "convert", at(name), at("back.ply")});
    EXPECT_EQ(back.status, 0) << back.err;
    EXPECT_THAT(back.complaints(), SizeIs(0)) << "there is nothing to leave out";
    const Mesh read = read_mesh(at("back.ply")).value();
    EXPECT_TRUE(read.reliability.empty() && read.scans.empty() && read.flags.empty()) << name;
  }
  EXPECT_THAT(run_command({"mesh", "convert", at("tent.ply"), at("copy.ply")}).complaints(), SizeIs(0));
  EXPECT_EQ(read_mesh(at("copy.ply")).value().reliability, mesh.reliability);
  EXPECT_THAT(bytes_of(at("copy.ply")), HasSubstr("\ncomment Mesh of Dubsar\n"));
  EXPECT_EQ(run_command({"mesh", "convert", at("tent.obj"), at("theirs.ply")}).status, 0);
  EXPECT_THAT(bytes_of(at("theirs.ply")), HasSubstr("\ncomment Converted by Dubsar from tent.obj\n"));
}

TEST_F(MeshCommand, WhatItDoesNotReadIsNamedOnTheOneLine) {
  std::ofstream(at("quality.ply"))
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property float quality\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0 1\n9 0 0 1\n0 9 0 1\n0 0 9 1\n3 0 1 2\n";
  for (const auto& [name, vertices] : {std::pair{"copy.ply", 4}, {"copy.stl", 3}}) {
    const Outcome copied = run_command({"mesh", "convert", at("quality.ply"), at(name), "--json"});
    EXPECT_EQ(copied.json()["vertices"], vertices);
    EXPECT_THAT(copied.complaints(),
                ElementsAre(HasSubstr("what Dubsar does not read is left out: vertex quality; keep ")));
    EXPECT_EQ(copied.err.find("vertices without a face (1)") != std::string::npos, vertices == 3)
        << copied.err;
  }
}

/// A strip that is turned over once on its way round.
TEST_F(MeshCommand, AStripThatTurnsIntoItselfIsNotToldToBeTurnedOver) {
  std::ofstream strip(at("strip.obj"));
  constexpr int kSteps = 24;
  for (int k = 0; k < kSteps; ++k) {
    const double round = 2 * std::acos(-1.0) * k / kSteps;
    for (const double side : {-4.0, 4.0}) {
      const double radius = 20 + side * std::cos(0.5 * round);
      strip << "v " << radius * std::cos(round) << ' ' << radius * std::sin(round) << ' '
            << side * std::sin(0.5 * round) << '\n';
    }
  }
  for (int k = 0; k < kSteps; ++k) {
    const bool last = k + 1 == kSteps;
    const int a = 2 * k + 1, b = a + 1, c = last ? 2 : a + 2, d = last ? 1 : a + 3;
    strip << "f " << b << ' ' << c << ' ' << a << "\nf " << d << ' ' << c << ' ' << b << '\n';
  }
  strip.close();
  const Outcome checked = run_command({"mesh", "check", at("strip.obj"), "--json"});
  EXPECT_EQ(checked.status, 1) << checked.err;
  EXPECT_EQ(checked.json()["inconsistent_faces"], 2);
  EXPECT_EQ(checked.json()["repeated_faces"], 0);
  EXPECT_EQ(checked.json()["inside_out"], true) << "as a whole";
  EXPECT_THAT(checked.err, HasSubstr("some of its faces run against their neighbours: mend these first"));
  EXPECT_EQ(checked.err.find("--turn-over"), std::string::npos) << checked.err;
}

TEST_F(MeshCommand, AUnitThatNobodySaidIsDoubtedWhereLengthsAreTold) {
  std::ofstream(at("metres.obj")) << "v 0 0 0\nv .03 0 0\nv .03 .03 0\nv 0 .03 0\nv .015 .015 .009\n"
                                     "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
  const char* const doubt = "as it stands it is 0.0434 mm large, perhaps its numbers are m";
  const Outcome checked = run_command({"mesh", "check", at("metres.obj"), "--json"});
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.complaints(), SizeIs(1)) << checked.err;
  EXPECT_THAT(checked.err, HasSubstr(doubt));
  EXPECT_EQ(checked.json()["unit_doubt"], doubt);
  const Outcome section = cut("metres.obj", "0,.015,.01", ".03,.015,.01", "cut.csv");
  EXPECT_EQ(section.status, 0) << section.err;
  EXPECT_THAT(section.complaints(), SizeIs(1)) << section.err;
  EXPECT_THAT(section.err, HasSubstr(doubt));
  EXPECT_EQ(section.json()["unit_doubt"], doubt);
  // Where somebody says it, and where the size is a tablet's.
  const Outcome said = run_command({"mesh", "check", at("metres.obj"), "--unit", "m", "--json"});
  EXPECT_THAT(said.complaints(), SizeIs(0)) << said.err;
  EXPECT_EQ(said.json()["unit_doubt"], nullptr);
  EXPECT_EQ(cut("tent.obj", "0,15,10", "30,15,10", "cut.csv").json()["unit_doubt"], nullptr);
}

TEST_F(MeshCommand, AUnitThatAHeaderWritesOutIsDoubtedInItsOwnNumbers) {
  for (const char* unit : {"um", "micrometers", "um (of the scanner)"}) {
    std::ofstream(at("micro.ply"))
        << "ply\nformat ascii 1.0\nobj_info unit " << unit
        << "\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0\n30 0 0\n0 30 0\n0 0 9\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 0 2 1\n";
    const Outcome checked = run_command({"mesh", "check", at("micro.ply"), "--json"});
    EXPECT_EQ(checked.json()["unit_doubt"],
              "as it stands it is 0.0434 mm large, perhaps its numbers are mm, cm")
        << unit << ": " << checked.err;
  }
}

TEST_F(MeshCommand, APlyDoesNotSayMillimetresOfNumbersThatNobodyKnows) {
  std::ofstream(at("metres.obj")) << "v 0 0 0\nv .03 0 0\nv .03 .03 0\nv 0 .03 0\nv .015 .015 .009\n"
                                     "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";
  const Outcome plain = run_command({"mesh", "convert", at("metres.obj"), at("unknown.ply")});
  EXPECT_EQ(plain.status, 0) << plain.err;
  EXPECT_THAT(plain.err, HasSubstr("perhaps its numbers are m"));
  EXPECT_THAT(bytes_of(at("unknown.ply")), Not(HasSubstr("obj_info unit")));
  EXPECT_THAT(run_command({"mesh", "check", at("unknown.ply")}).err, HasSubstr("perhaps its numbers are m"));
  const Outcome said = run_command({"mesh", "convert", at("metres.obj"), at("said.ply"), "--unit", "m"});
  EXPECT_THAT(said.complaints(), SizeIs(0)) << said.err;
  EXPECT_THAT(bytes_of(at("said.ply")), HasSubstr("obj_info unit mm"));
  run_command({"mesh", "convert", at("tent.obj"), at("tent.ply")});
  EXPECT_THAT(bytes_of(at("tent.ply")), HasSubstr("obj_info unit mm")) << "its size is a tablet's";
}

TEST_F(MeshCommand, ACutFromPlacesOffTheSurfaceSaysSo) {
  EXPECT_THAT(cut("tent.obj", "2,15,1.2", "28,15,1.2", "cut.csv").complaints(), SizeIs(0));
  const Outcome off = cut("tent.obj", "2,15,3", "28,15,1.2", "cut.csv");
  EXPECT_EQ(off.status, 0) << off.err;
  EXPECT_THAT(
      off.complaints(),
      ElementsAre(HasSubstr("tent.obj: the place of --from lies 1.80 mm from the surface that is cut")));
}

TEST_F(MeshCommand, ACutThatMeetsNothingWritesNothing) {
  for (const char* file : {"cut.csv", "cut.svg"}) {
    const Outcome beside = cut("tent.obj", "200,0,0", "220,0,0", file);
    EXPECT_EQ(beside.status, 1);
    EXPECT_THAT(beside.err, HasSubstr("nothing is cut"));
    EXPECT_EQ(beside.json()["pieces"], 0);
    EXPECT_FALSE(fs::exists(at(file)));
  }
}

TEST_F(MeshCommand, WhatHasNoFacesIsNoMesh) {
  std::ofstream(at("points.ply"))
      << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
         "end_header\n0 0 0\n";
  const Outcome converted = run_command({"mesh", "convert", at("points.ply"), at("points.stl")});
  EXPECT_EQ(converted.status, 2) << converted.out;
  EXPECT_THAT(converted.complaints(), SizeIs(1)) << converted.err;
  EXPECT_FALSE(fs::exists(at("points.stl")));
  EXPECT_EQ(cut("points.ply", "0,0,0", "1,0,0", "cut.csv").status, 2);
  EXPECT_EQ(run_command({"mesh", "check", at("points.ply")}).status, 2) << "nothing is no 2-manifold either";
}

}  // namespace
}  // namespace dubsar
