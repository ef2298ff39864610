// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar stitch with the poses of a file: what it does not use, or cannot believe, is told.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "acquisition/session_store.h"
#include "formats/atomic_file.h"
#include "formats/file_label_reader.h"
#include "formats/grid_file.h"
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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;
using ::testing::SizeIs;

class StitchCommand : public ::testing::Test {
 protected:
  StitchCommand() : poses_(3) {
    test::write_bumpy_scans(at("scans"), 3);
    for (int k = 0; k < 3; ++k) {
      ScanPose& pose = poses_[static_cast<std::size_t>(k)];
      pose.id = k;
      pose.file = test::scan_name(k);
      pose.status = PoseStatus::kRegistered;
      pose.model_from_scanner = test::bumpy_pose(k);
    }
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] Outcome stitched(const char* mesh = "mesh.ply") const {
    EXPECT_TRUE(write_poses(at("poses.json"), poses_));
    return run_command({"stitch", at("scans"), "--poses", at("poses.json"), "-o", at(mesh)});
  }
  /// One more scan, scan_9.ply, whose pose is right, is named as left out of the three others' mesh.
  void expect_left_out(const char* why) {
    poses_.push_back(poses_[1]);
    poses_.back().id = 3;
    poses_.back().file = "scan_9.ply";
    const Outcome outcome = stitched();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(std::string("scan_9.ply is left out: ") + why));
    EXPECT_THAT(outcome.out, HasSubstr("faces of 3 scans"));
  }
  std::vector<ScanPose> poses_;

 private:
  test::TemporaryFolder folder_;
};

TEST_F(StitchCommand, SaysNothingWhereAllIsWell) {
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(0)) << outcome.err;
}

TEST_F(StitchCommand, SaysWhatAFormatCannotHold) {
  const Outcome outcome = stitched("mesh.stl");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(),
              ElementsAre(HasSubstr("mesh.stl: STL holds no reliability, sigma, scans or flags: left out; "
                                    "stitch into a .ply to have them")));
}

TEST_F(StitchCommand, SaysThatSigmaLacksWhatPosesDoNotSayOfThemselves) {
  const auto json = [&](std::size_t with_sigma, double first_mm = 0) {
    nlohmann::json root;
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      const RigidTransform& pose = poses_[k].model_from_scanner;
      Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
      matrix.topLeftCorner<3, 3>() = pose.rotation;
      matrix.topRightCorner<3, 1>() = pose.translation_mm;
      root["scans"].push_back(
          {{"file", poses_[k].file},
           {"model_from_scanner", std::vector<double>(matrix.data(), matrix.data() + 16)}});
      if (k < with_sigma) {
        root["scans"].back()["sigma_mm"] = k == 0 ? first_mm : 0.01;
      }
    }
    return root.dump();
  };
  const auto of = [&](const char* file, const std::string& text) {
    EXPECT_TRUE(write_file_atomically(at(file), text));
    const Outcome outcome = run_command({"stitch", at("scans"), "--poses", at(file), "-o", at("mesh.ply")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.complaints();
  };
  const auto says = [](const char* of_how_many) {
    return ElementsAre(HasSubstr(std::string(of_how_many) +
                                 " poses say no sigma_mm: what these are off by is not "
                                 "in the sigma of the mesh's vertices"));
  };
  EXPECT_THAT(of("all.json", json(3)), SizeIs(0));
  EXPECT_THAT(of("frame.json", json(1)), says("2 of 3"));
  EXPECT_THAT(of("one.json", json(2)), says("1 of 3"));
  EXPECT_THAT(of("against it.json", json(2, 0.01)), SizeIs(0)) << "the others lie against the third";
  EXPECT_THAT(of("none.json", json(0)), says("3 of 3"));
  std::string conf;
  for (const ScanPose& pose : poses_) {
    const RigidTransform& at_mm = pose.model_from_scanner;
    const Eigen::Quaterniond q(Eigen::Matrix3d(at_mm.rotation.transpose()));
    conf += fmt::format("bmesh {} {} {} {} {} {} {} {}\n", pose.file, at_mm.translation_mm.x(),
                        at_mm.translation_mm.y(), at_mm.translation_mm.z(), q.x(), q.y(), q.z(), q.w());
  }
  EXPECT_THAT(of("bun.conf", conf), says("3 of 3"));
}

TEST_F(StitchCommand, NamesAScanThatTheFileHasNoPoseOf) {
  poses_.pop_back();
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(2) + " is left out"));
}

TEST_F(StitchCommand, TakesNoFileWithTwoPosesOfAScan) {
  poses_.push_back(poses_.back());
  poses_.back().file = "elsewhere/" + poses_.back().file;  // the same scan by the name it is looked up by
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("two poses of " + test::scan_name(2)));
  EXPECT_FALSE(fs::exists(at("mesh.ply")));
}

TEST_F(StitchCommand, NamesAScanThatLiesByItself) {
  poses_[1].model_from_scanner.translation_mm += Eigen::Vector3d(90, 0, 0);
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(1) + " overlaps no other scan"));
}

/// Many pairs that lie apart, and many files with one fault, are a line each.
TEST_F(StitchCommand, SaysInOneLineWhichOfManyScansIsAtFault) {
  constexpr int kScans = 6;
  poses_.clear();
  for (int k = 0; k < kScans; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    grid.spacing_mm = 1.5;
    ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / test::scan_name(k), grid));
    ScanPose& pose = poses_.emplace_back();
    pose.id = k;
    pose.file = test::scan_name(k);
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = test::bumpy_pose(k);
  }
  poses_[4].model_from_scanner.translation_mm.z() += 0.5;
  ASSERT_TRUE(write_poses(at("poses.json"), poses_));
  const Outcome outcome =
      run_command({"stitch", at("scans"), "--poses", at("poses.json"), "-o", at("mesh.ply"), "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(3)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(0) + ": its header says a spacing of 1.5 mm"));
  EXPECT_THAT(outcome.err, HasSubstr("what is said of scan_0.ply is so of 5 others: scan_1.ply, scan_2.ply, "
                                     "scan_3.ply and 2 more"));
  EXPECT_THAT(outcome.err, HasSubstr("5 of 15 pairs of scans lie apart where they overlap, by up to 0."));
  EXPECT_THAT(outcome.err, HasSubstr("at fault seem: scan_4.ply (apart from 5 others, 0."));
  const nlohmann::json apart = outcome.json()["apart"];
  ASSERT_THAT(apart, SizeIs(5));
  EXPECT_EQ(apart[0]["ids"], nlohmann::json::array({0, 4}));
  EXPECT_GT(apart[0]["mm"].get<double>(), 0.4) << "of 0.5 mm, what pairs within reach show of it";
  EXPECT_LE(apart[0]["mm"].get<double>(), 0.5);
}

TEST_F(StitchCommand, AScanOfOneRowIsNotCalledMisplaced) {
  RangeGrid row;
  row.allocate(1, 40);
  row.spacing_mm = 0.1;
  for (std::size_t i = 0; i < row.size(); ++i) {
    row.x[i] = 0.1F * static_cast<float>(i);
    row.valid[i] = 1;
  }
  ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / "scan_9.ply", row));
  expect_left_out("it has no surface");
}

TEST_F(StitchCommand, LeavesOutAScanThatCameTwice) {
  ASSERT_EQ(stitched().status, 0);
  const Mesh once = read_mesh(at("mesh.ply")).value();
  fs::copy_file(at("scans") + "/" + test::scan_name(1), at("scans") + "/scan_9.ply");
  expect_left_out("it has the very samples of scan_1.ply");
  const Mesh twice = read_mesh(at("mesh.ply")).value();
  EXPECT_EQ(twice.positions, once.positions);
  EXPECT_EQ(twice.sigma_mm, once.sigma_mm);
  EXPECT_EQ(twice.scans, once.scans);

  const Outcome planned = run_command({"plan", at("scans"), "--poses", at("poses.json"), "--json"});
  EXPECT_THAT(planned.err, HasSubstr("scan 3: it has the very samples of scan 1"));
  const nlohmann::json warnings = planned.json().at("checklist").at("warnings");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings.front().at("scan"), 3);
}

TEST_F(StitchCommand, RefusesPosesInTheNumbersOfAMap) {
  for (ScanPose& pose : poses_) {
    pose.model_from_scanner.translation_mm.x() += 1e7;
  }
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(0) + ": its pose puts it 10000 m from the origin"));
  EXPECT_FALSE(fs::exists(at("mesh.ply")));
  for (const Outcome& other :
       {run_command({"plan", at("scans"), "--poses", at("poses.json")}),
        run_command({"register", at("scans"), "--from-poses", at("poses.json"), "-o", at("out.json")})}) {
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.complaints(), SizeIs(1)) << other.err;
    EXPECT_THAT(other.err, HasSubstr(test::scan_name(0) + ": its pose puts it 10000 m from the origin"));
  }
}

/// Each of two scans has a finger of its own before it, where the others see the field.
TEST_F(StitchCommand, LeavesOutFingersInSeveralScans) {
  const auto highest = [&]() {
    float out = 0;
    const Result<Mesh> mesh = read_mesh(at("mesh.ply"));
    EXPECT_TRUE(mesh);
    for (const Eigen::Vector3f& p : mesh->positions) {
      out = std::max(out, p.z());
    }
    return out;
  };
  ASSERT_EQ(stitched().status, 0);
  const float of_the_field = highest();
  std::vector<RangeGrid> grids{test::bumpy_scan(0)};
  for (const int number : {1, 2}) {
    RangeGrid grid = test::bumpy_scan(number);
    const Eigen::Vector3d middle =
        test::bumpy_pose(number).inverse() * Eigen::Vector3d(12 * number - 18, 3, 0);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const Eigen::Vector2f away = (grid.point(i).cast<double>() - middle).head<2>().cast<float>();
      grid.z[i] += away.norm() < 5 ? 4 + std::sqrt(25.0F - away.squaredNorm()) : 0;
    }
    ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / test::scan_name(number), grid));
    grids.push_back(std::move(grid));
  }
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(2)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("something was in the way of scan 1: "));
  EXPECT_THAT(outcome.err, HasSubstr("left out (looked through by scans 0 and 2)"));
  EXPECT_THAT(outcome.err, HasSubstr("something was in the way of scan 2: "));
  EXPECT_LT(highest(), of_the_field + 0.5F);

  {  // of a session, which the command itself keeps from others meanwhile
    SessionStore store = SessionStore::open_or_create(at("session")).value();
    for (const RangeGrid& grid : grids) {
      ASSERT_TRUE(store.add_grid(grid));
    }
    ASSERT_TRUE(store.save_poses(poses_));
  }
  fs::remove(at("mesh.ply"));
  const Outcome of_session = test::run_command({"stitch", at("session"), "-o", at("mesh.ply")});
  EXPECT_EQ(of_session.status, 0) << of_session.err;
  EXPECT_LT(highest(), of_the_field + 0.5F);
}

TEST_F(StitchCommand, AMeshOfAFolderSaysWhatAllItsScansSay) {
  const auto labelled = [&](int number, std::vector<std::pair<std::string, std::string>> words) {
    EXPECT_TRUE(write_grid_ply(at("scans") + "/" + test::scan_name(number), test::bumpy_scan(number),
                               {.label = label_of_words(std::move(words))}));
  };
  const auto words_of_mesh = [&] {
    EXPECT_EQ(stitched().status, 0);
    return read_file_label(at("mesh.ply")).words;
  };
  for (int k = 0; k < 3; ++k) {
    labelled(k, {{"Museum number", "BM 1"}, {"Rights", "CC0"}});
  }
  EXPECT_THAT(words_of_mesh(), ElementsAre(Pair("Museum number", "BM 1"), Pair("Rights", "CC0")));
  labelled(1, {{"Museum number", "BM 2"}});
  EXPECT_THAT(words_of_mesh(), SizeIs(0));
  labelled(2, {{"SIMULATED", "no tablet"}});
  EXPECT_THAT(words_of_mesh(), ElementsAre(Pair("SIMULATED", HasSubstr("there is no such tablet"))));
}

/// Of a package's `scans/grids`: nothing is said there but the device.
TEST_F(StitchCommand, AMeshOfGridsOfTheSimulatorSaysThatItWasMadeUp) {
  const auto words_with_device = [&](const char* device) {
    for (int k = 0; k < 3; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      grid.source = test::scan_name(k);
      grid.device = device;
      EXPECT_TRUE(write_grid_file(
          fs::path(at("scans")) / fs::path(test::scan_name(k)).replace_extension("grid"), grid));
      fs::remove(fs::path(at("scans")) / test::scan_name(k));
    }
    EXPECT_EQ(stitched().status, 0);
    return read_file_label(at("mesh.ply")).words;
  };
  EXPECT_THAT(words_with_device("sim-3"),
              ElementsAre(Pair("SIMULATED", HasSubstr("there is no such tablet"))));
  EXPECT_THAT(words_with_device("simplex 3"), SizeIs(0));
}

/// Those of a package's `scans/ply` keep the names of the files that they once came from.
TEST_F(StitchCommand, AMeshOfScansThatGoByOtherNamesThanTheirFilesSaysWhatTheySay) {
  for (int k = 0; k < 3; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    grid.source = "first_" + test::scan_name(k);
    GridPlyOptions options;
    options.keep_source = true;
    options.label = label_of_words({{"SIMULATED", "no tablet"}, {"Museum number", "BM 1"}});
    ASSERT_TRUE(write_grid_ply(at("scans") + "/" + test::scan_name(k), grid, options));
  }
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(read_file_label(at("mesh.ply")).words,
              ElementsAre(Pair("SIMULATED", "no tablet"), Pair("Museum number", "BM 1")));
}

TEST_F(StitchCommand, WritesNoMeshOfNoFaces) {
  fs::remove_all(at("scans"));
  fs::create_directory(at("scans"));
  RangeGrid sparse = test::bumpy_scan(0);
  for (int row = 0; row < sparse.rows; ++row) {
    for (int col = 0; col < sparse.cols; ++col) {
      sparse.valid[sparse.index(row, col)] &= row % 2 == 0 && col % 2 == 0 ? 1 : 0;
    }
  }
  ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / test::scan_name(0), sparse));
  const Outcome outcome = stitched();
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("no surface"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("2-manifold")));
  EXPECT_FALSE(fs::exists(at("mesh.ply")));
}

}  // namespace
}  // namespace dubsar
