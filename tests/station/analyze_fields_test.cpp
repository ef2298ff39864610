// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze: what it says of a wrong unit, and the fields that it writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/atomic_file.h"
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

}  // namespace
}  // namespace dubsar
