// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze: what it says of a wrong unit, and the fields that it writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "tests/analysis/support/shapes.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;

class AnalyzeFields : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] std::string sphere_file(const char* name, float radius_mm, int levels) const {
    EXPECT_TRUE(write_mesh(at(name), shapes::sphere(radius_mm, levels)));
    return at(name).string();
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(AnalyzeFields, AMeshInMetresIsTakenForOneAndThatIsTold) {
  const std::string mesh = sphere_file("metres.stl", 0.015F, 3);
  const Outcome assumed = run_command({"analyze", mesh, "-o", at("w.json").string(), "--json"});
  EXPECT_EQ(assumed.status, 0);
  EXPECT_THAT(assumed.err, HasSubstr("its numbers are taken for m"));
  EXPECT_EQ(assumed.json()["unit_assumed"], "m");
  const Outcome said = run_command({"analyze", mesh, "-o", at("w.json").string(), "--unit", "m", "--json"});
  EXPECT_EQ(said.status, 0);
  EXPECT_FALSE(said.json().contains("unit_assumed"));
  EXPECT_EQ(run_command({"analyze", mesh, "-o", at("w.json").string(), "--unit", "mm"}).status, 0);
  const std::string micrometres = sphere_file("um.stl", 15000, 3);
  EXPECT_THAT(run_command({"analyze", micrometres, "-o", at("w.json").string()}).err,
              HasSubstr("its numbers are taken for um"));
  // As millimetres such numbers would be too coarse: that must not be what is told.
  const std::string large = sphere_file("large_um.stl", 100000, 3);
  EXPECT_THAT(run_command({"analyze", large, "-o", at("w.json").string()}).err,
              HasSubstr("its numbers are taken for um"));
}

TEST_F(AnalyzeFields, CentimetresAndInchesAreNamed) {
  const std::string mesh = sphere_file("small.stl", 1.5F, 3);
  const Outcome doubted = run_command({"analyze", mesh, "-o", at("w.json").string()});
  EXPECT_EQ(doubted.status, 2);
  EXPECT_FALSE(fs::exists(at("w.json")));
  EXPECT_THAT(doubted.err,
              HasSubstr("repeat it with --unit cm (30 x 30 x 30 mm), --unit mm (3 x 3 x 3 mm) or "
                        "--unit in (76.2 x 76.2 x 76.2 mm)"));
  EXPECT_EQ(run_command({"analyze", mesh, "-o", at("w.json").string(), "--unit", "mm"}).status, 0);
}

TEST_F(AnalyzeFields, AMeshTooFarFromItsOriginIsRefused) {
  Mesh mesh = shapes::sphere(15, 3);
  for (Eigen::Vector3f& p : mesh.positions) {
    p.x() += 250000;
  }
  ASSERT_TRUE(write_mesh(at("far.ply"), mesh));
  const Outcome outcome = run_command({"analyze", at("far.ply").string(), "-o", at("w.json").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("so far from the origin of its numbers that places are good to 0.016 mm"));
  EXPECT_FALSE(fs::exists(at("w.json")));
}

TEST_F(AnalyzeFields, PicturesAndInvariantsAreWritten) {
  const Outcome outcome =
      run_command({"analyze", sphere_file("ball.ply", 60, 4), "-o", at("w.json").string(), "--pictures",
                   at("fields").string(), "--invariants", at("ball.mat").string()});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name :
       {"reliability", "curvature", "openness", "free_surface", "height", "invariants", "surface"}) {
    const auto coloured = read_mesh(at("fields") / (std::string(name) + ".ply"));
    ASSERT_TRUE(coloured) << name;
    EXPECT_EQ(coloured->colours.size(), coloured->positions.size()) << name;
    EXPECT_GT(fs::file_size(at("fields") / (std::string(name) + ".png")), 1000U) << name;
  }
  const auto mat = read_whole_file(at("ball.mat"));
  ASSERT_TRUE(mat);
  EXPECT_EQ(std::count(mat->begin(), mat->end(), '\n'), 2 + 1026);
}

TEST_F(AnalyzeFields, PicturesAndInvariantsSayWhatTheyAreOf) {
  const FileLabel label = label_of_words(
      {{"SIMULATED", "No such tablet."}, {"Museum number", "BM 12345"}, {"Rights", "A Museum; CC BY 4.0"}});
  ASSERT_TRUE(write_mesh(at("ball.ply"), shapes::sphere(20, 4), label));
  const Outcome outcome =
      run_command({"analyze", at("ball.ply").string(), "-o", at("w.json").string(), "--pictures",
                   at("fields").string(), "--invariants", at("ball.mat").string()});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name : {"height", "surface", "invariants", "wedges"}) {
    const fs::path stem = at("fields") / name;
    const FileLabel of_mesh = read_file_label(stem.string() + ".ply");
    EXPECT_TRUE(of_mesh.simulated) << name;
    EXPECT_EQ(of_mesh.words, label.words) << name;
    EXPECT_EQ(read_mesh_label(stem.string() + ".ply").origin.find("Converted by Dubsar from "), 0U) << name;
    const auto png = read_whole_file(stem.string() + ".png");
    ASSERT_TRUE(png) << name;
    EXPECT_THAT(*png, HasSubstr("SIMULATED: No such tablet.\nMuseum number: BM 12345\n")) << name;
  }
  const auto mat = read_whole_file(at("ball.mat"));
  ASSERT_TRUE(mat);
  EXPECT_THAT(*mat, HasSubstr("\n# SIMULATED: No such tablet.\n# Museum number: BM 12345\n"));
  const fs::path obj = at("height.obj");
  ASSERT_EQ(run_command({"mesh", "convert", (at("fields") / "height.ply").string(), obj.string()}).status, 0);
  EXPECT_EQ(read_file_label(obj).words, label.words) << "and what is made of them";
}

TEST_F(AnalyzeFields, PicturesAreNotWrittenOverAMesh) {
  const std::string mesh = sphere_file("surface.ply", 15, 3);
  const std::string before = read_whole_file(mesh).value_or("");
  const auto told = [&](const std::string& pictures, const std::vector<std::string>& more) {
    test::Arguments words{"analyze", mesh, "-o", at("w.json").string(), "--pictures", pictures};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_THAT(told(fs::path(mesh).parent_path().string(), {}),
              HasSubstr("what is read would be written over"));
  EXPECT_EQ(read_whole_file(mesh).value_or(""), before);
  const fs::path folder = at("fields");
  fs::create_directory(folder);
  EXPECT_THAT(told(folder.string(), {"--mesh-out", (folder / "wedges.ply").string()}),
              HasSubstr("two outputs would be written to one place"));
  EXPECT_FALSE(fs::exists(at("w.json")));
}

/// The values of each line, as text; the lines are numbered in their order.
std::vector<std::string> values_of(const fs::path& mat) {
  std::vector<std::string> out;
  std::ifstream in(mat);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with('#')) {
      const std::size_t blank = line.find(' ');
      EXPECT_EQ(line.substr(0, blank), std::to_string(out.size()));
      out.push_back(line.substr(blank));
    }
  }
  return out;
}

TEST_F(AnalyzeFields, LinesOfAMatAreOfTheVerticesOfThePlyThatWasRead) {
  const Mesh ball = shapes::sphere(60, 3);
  const std::size_t vertices = ball.positions.size();
  constexpr std::size_t kOnSeam = 40;  // stand twice, as with a texture
  ASSERT_TRUE(write_mesh(at("plain.ply"), ball));
  std::vector<std::size_t> vertex_of;
  std::vector<std::size_t> first(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    first[v] = vertex_of.size();
    vertex_of.insert(vertex_of.end(), v < kOnSeam ? 2 : 1, v);
  }
  std::ofstream seam(at("seam.ply"));
  seam.precision(9);
  seam << "ply\nformat ascii 1.0\nelement vertex " << vertex_of.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
       << "element face " << ball.faces.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const std::size_t v : vertex_of) {
    seam << ball.positions[v].x() << ' ' << ball.positions[v].y() << ' ' << ball.positions[v].z() << " 0 0\n";
  }
  for (std::size_t f = 0; f < ball.faces.size(); ++f) {
    seam << 3;
    for (const std::uint32_t v : ball.faces[f]) {
      seam << ' ' << first[v] + (v < kOnSeam ? f % 2 : 0);
    }
    seam << '\n';
  }
  seam.close();
  const auto measured = [&](const char* mesh, const char* mat, const std::vector<std::string>& more = {}) {
    test::Arguments words{"analyze",      at(mesh).string(),
                          "-o",           at((std::string(mat) + ".json").c_str()).string(),
                          "--invariants", at(mat).string()};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(measured("plain.ply", "plain.mat"), Not(HasSubstr("its lines are of")));
  EXPECT_THAT(measured("seam.ply", "seam.mat"), Not(HasSubstr("its lines are of")));
  const std::vector<std::string> plain = values_of(at("plain.mat"));
  const std::vector<std::string> of_file = values_of(at("seam.mat"));
  ASSERT_EQ(plain.size(), vertices);
  ASSERT_EQ(of_file.size(), vertices + kOnSeam);
  for (std::size_t line = 0; line < of_file.size(); ++line) {
    EXPECT_EQ(of_file[line], plain[vertex_of[line]]) << line;
  }
  const std::string counts = std::to_string(vertices + kOnSeam) + " vertices of seam.ply, not of the " +
                             std::to_string(vertices) + " of ";
  EXPECT_THAT(measured("seam.ply", "out.mat", {"--mesh-out", at("out.ply").string()}),
              HasSubstr("out.mat: its lines are of the " + counts + at("out.ply").string()));
  // Of an STL nobody knows how its reader counts the corners.
  ASSERT_TRUE(write_mesh(at("ball.stl"), ball));
  EXPECT_THAT(
      measured("ball.stl", "stl.mat"),
      HasSubstr("stl.mat: its lines are of the " + std::to_string(vertices) +
                " vertices of the measured mesh, not of the " + std::to_string(3 * ball.faces.size()) +
                " of ball.stl; use the vertices of --mesh-out"));
  EXPECT_EQ(values_of(at("stl.mat")).size(), vertices);
}

}  // namespace
}  // namespace dubsar
