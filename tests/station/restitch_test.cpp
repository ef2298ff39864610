// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A package alone gives its model again, from its grids and from its scans in PLY.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "acquisition/session_store.h"
#include "formats/mesh_io.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::SizeIs;

class Restitch : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// A scan of the bumpy field in a file of that name.
  void put(const std::string& file, int number) const {
    fs::create_directories(at(file).parent_path());
    ASSERT_TRUE(write_grid_ply(at(file), test::bumpy_scan(number)));
  }
  void scan(const std::string& folder) const {
    ASSERT_EQ(run_command({"scan", "--device", "replay:" + at(folder).string(), "--session",
                           at("session").string(), "--json"})
                  .status,
              1);
  }
  void pack() const {
    ASSERT_EQ(run_command({"export", at("session").string(), "--to", at("bag").string(), "--without",
                           "renderings,features,wedges"})
                  .status,
              0);
    session_model_ = read_mesh(at("bag/data/model/session.ply")).value();
    ASSERT_EQ(read_poses(poses())->size(), 3U);
  }
  [[nodiscard]] fs::path poses() const { return at("bag/data/scans/poses.json"); }

  /// What the package's poses and those scans give is the package's model, and nothing is complained of.
  void expect_the_model_of(const fs::path& scans) const {
    const Outcome outcome =
        run_command({"stitch", scans.string(), "--poses", poses().string(), "-o", at("again.ply").string()});
    ASSERT_EQ(outcome.status, 0) << scans << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(0)) << scans << outcome.err;
    const Mesh again = read_mesh(at("again.ply")).value();
    ASSERT_EQ(again.faces, session_model_.faces) << scans;
    ASSERT_EQ(again.positions.size(), session_model_.positions.size());
    for (std::size_t v = 0; v < again.positions.size(); ++v) {
      ASSERT_LT((again.positions[v] - session_model_.positions[v]).norm(), 1e-4) << scans << " " << v;
    }
  }

 private:
  test::TemporaryFolder folder_;
  mutable Mesh session_model_;
};

TEST_F(Restitch, EitherFormOfTheScansGivesTheModel) {
  // Original names that are those of other scans in the package.
  put("scans/001.ply", 0);
  put("scans/002.ply", 1);
  put("scans/003.ply", 2);
  scan("scans");
  pack();
  expect_the_model_of(at("bag/data/scans/grids"));
  expect_the_model_of(at("bag/data/scans/ply"));
  expect_the_model_of(at("scans"));
  fs::create_directories(at("taken out"));
  for (const char* form : {"grids", "ply"}) {
    fs::copy(at("bag/data/scans") / form, at("taken out") / form, fs::copy_options::recursive);
    expect_the_model_of(at("taken out") / form);
  }
}

TEST_F(Restitch, ScansOfOneNameAreToldApartInThePackage) {
  {
    Result<SessionStore> store = SessionStore::open_or_create(at("session"));
    ASSERT_TRUE(store);
    for (int number = 0; number < 3; ++number) {
      RangeGrid grid = test::bumpy_scan(number);
      grid.source = "scan.ply";
      ASSERT_TRUE(store->add_grid(grid));
    }
  }
  ASSERT_EQ(run_command({"register", at("session").string()}).status, 0);
  pack();
  expect_the_model_of(at("bag/data/scans/grids"));
  expect_the_model_of(at("bag/data/scans/ply"));
  // Elsewhere nothing tells which is which, and none is guessed.
  put("noon/scan.ply", 1);
  const Outcome unknown = run_command(
      {"stitch", at("noon").string(), "--poses", poses().string(), "-o", at("wrong.ply").string()});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_FALSE(fs::exists(at("wrong.ply")));
}

}  // namespace
}  // namespace dubsar
