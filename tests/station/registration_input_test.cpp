// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that cannot be registered, through the command: never a pose, always a reason.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "formats/grid_ply.h"
#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using ::testing::AnyOf;
using testing::bumpy;
using testing::FieldScan;
using ::testing::HasSubstr;
using testing::Height;
using testing::pose_of;
using testing::scan_field;

class RegistrationInput : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const char* name) const { return folder_.path() / name; }
  void put(int number, const RangeGrid& grid) const {
    fs::create_directories(at("scans"));
    ASSERT_TRUE(write_grid_ply(at("scans") / test::scan_name(number), grid));
  }
  /// Scan `number` of a surface, taken from `pose`.
  void put(int number, const Height& surface, const RigidTransform& pose, FieldScan scan = {}) const {
    scan.seed = 30 + static_cast<std::uint64_t>(number);
    put(number, scan_field(surface, pose, scan));
  }
  [[nodiscard]] nlohmann::json registered(const Arguments& more = {}) const {
    Arguments words{"register", at("scans").string(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = test::run_command(words);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_FALSE(outcome.timed_out);
    return outcome.json()["scans"];
  }
  void expect_no_pose(const nlohmann::json& scan) const {
    EXPECT_THAT(scan["status"].get<std::string>(), AnyOf("unsure", "failed")) << scan;
    EXPECT_FALSE(scan["reason"].get<std::string>().empty()) << scan;
  }
  [[nodiscard]] const fs::path& folder() const { return folder_.path(); }

 private:
  test::TemporaryFolder folder_;
};

std::string reason(const nlohmann::json& scan) {
  return scan["reason"].get<std::string>();
}

RangeGrid scaled(RangeGrid grid, double factor) {
  for (auto* values : {&grid.x, &grid.y, &grid.z}) {
    for (float& v : *values) {
      v *= static_cast<float>(factor);
    }
  }
  grid.spacing_mm *= factor;
  return grid;
}

TEST_F(RegistrationInput, APlane) {
  for (int k = 0; k < 3; ++k) {
    FieldScan scan;
    scan.half_mm = 20;
    put(
        k, [](double, double) { return 0.0; }, pose_of(4.0 * k, 0, 25.0 * k, {2.0 * k, 0, 0}), scan);
  }
  const nlohmann::json scans = registered();
  expect_no_pose(scans[1]);
  expect_no_pose(scans[2]);
}

TEST_F(RegistrationInput, ASphere) {
  const Height sphere = [](double x, double y) {
    return std::sqrt(std::max(1.0, 1600.0 - x * x - y * y)) - 40.0;
  };
  for (int k = 0; k < 3; ++k) {
    FieldScan scan;
    scan.half_mm = 20;
    put(k, sphere, pose_of(4.0 * k, 0, 25.0 * k, {2.0 * k, 0, 0}), scan);
  }
  const nlohmann::json scans = registered();
  expect_no_pose(scans[1]);
  expect_no_pose(scans[2]);
}

TEST_F(RegistrationInput, ASingleLineOfSamples) {
  put(0, bumpy(11), {});
  const RangeGrid whole = scan_field(bumpy(11), {}, {});
  RangeGrid row;
  row.allocate(1, whole.cols);
  row.spacing_mm = whole.spacing_mm;
  RangeGrid in_the_grid;
  in_the_grid.allocate(whole.rows, whole.cols);
  in_the_grid.spacing_mm = whole.spacing_mm;
  const std::size_t from = whole.index(whole.rows / 2, 0);
  for (std::size_t c = 0; c < static_cast<std::size_t>(whole.cols); ++c) {
    for (auto [grid, to] : {std::pair{&row, c}, std::pair{&in_the_grid, from + c}}) {
      grid->x[to] = whole.x[from + c];
      grid->y[to] = whole.y[from + c];
      grid->z[to] = whole.z[from + c];
      grid->valid[to] = whole.valid[from + c];
    }
  }
  put(1, row);
  put(2, in_the_grid);
  const nlohmann::json scans = registered();
  EXPECT_EQ(scans[0]["status"], "registered");
  expect_no_pose(scans[1]);
  expect_no_pose(scans[2]);
}

TEST_F(RegistrationInput, NoOverlap) {
  const Height surface = bumpy(13, 120);
  FieldScan left;
  left.high_x_mm = -3;
  FieldScan right;
  right.low_x_mm = 3;
  put(0, surface, {}, left);
  put(1, surface, pose_of(0, 0, 40, {0, 0, 0}), right);
  put(2, bumpy(99), {});
  const nlohmann::json scans = registered();
  expect_no_pose(scans[1]);
  expect_no_pose(scans[2]);
}

TEST_F(RegistrationInput, AnotherUnitIsNamed) {
  put(0, bumpy(16), {});
  const RangeGrid second = scan_field(bumpy(16), pose_of(4, 3, 30, {1, 0, 0}), {});
  put(1, scaled(second, 0.001));
  put(2, scaled(second, 1.0 / 25.4));
  put(3, scaled(second, 1000));
  put(4, scaled(second, 0.1));
  const nlohmann::json scans = registered();
  const std::vector<std::string> unit{"", "metres", "inches", "micrometres", "centimetres"};
  const std::vector<std::string> mend{"", "--unit m ", "--unit in ", "--unit um ", "--unit cm "};
  for (std::size_t k = 1; k < unit.size(); ++k) {
    EXPECT_THAT(reason(scans[k]), HasSubstr(mend[k])) << k;
    expect_no_pose(scans[k]);
    EXPECT_THAT(reason(scans[k]), HasSubstr(unit[k])) << k;
    EXPECT_THAT(reason(scans[k]), HasSubstr("unit")) << k;
  }
}

TEST_F(RegistrationInput, AFolderInMetresThatWasReadAsMillimetresIsNamed) {
  for (int k = 0; k < 2; ++k) {
    put(k, scaled(scan_field(bumpy(16), pose_of(4 * k, 3 * k, 30 * k, {1, 0, 0}), {}), 0.001));
  }
  const nlohmann::json scans = registered();
  for (const nlohmann::json& scan : scans) {
    expect_no_pose(scan);
    EXPECT_THAT(reason(scan), HasSubstr("--unit m"));
  }
  const Outcome said = test::run_command({"register", at("scans").string(), "--unit", "m", "--json"});
  EXPECT_EQ(said.status, 0) << said.out << said.err;
}

TEST_F(RegistrationInput, AWrongWordForTheUnitIsNotAnsweredWithAnotherWrongOne) {
  for (int k = 0; k < 2; ++k) {
    put(k, scan_field(bumpy(16), pose_of(4 * k, 3 * k, 30 * k, {1, 0, 0}), {}));
  }
  for (const char* said : {"um", "m"}) {
    const Outcome wrong = test::run_command({"register", at("scans").string(), "--unit", said, "--json"});
    EXPECT_EQ(wrong.status, 1) << wrong.err;
    EXPECT_THAT(reason(wrong.json()["scans"][0]), HasSubstr(std::string("--unit mm in place of ") + said));
  }
}

TEST_F(RegistrationInput, SpacingsThatDifferTenfold) {
  const Height surface = bumpy(17);
  FieldScan fine;
  fine.half_mm = 12;
  fine.spacing_mm = 0.05;
  fine.noise_mm = 0.005;
  FieldScan coarse;
  coarse.spacing_mm = 0.5;
  const std::vector<RigidTransform> truth{{}, pose_of(3, -4, 35, {1, 2, 0})};
  put(0, surface, truth[0], coarse);
  put(1, surface, truth[1], fine);
  const Outcome outcome = test::run_command({"register", at("scans").string(), "--json"});
  const auto poses = parse_poses(outcome.out, "answer");
  ASSERT_TRUE(poses.has_value()) << outcome.out;
  if (poses->at(1).status == PoseStatus::kRegistered) {
    const Eigen::Vector3d p(5, -5, 0);
    EXPECT_LT((poses->at(1).model_from_scanner * p - truth[1] * p).norm(), 0.05);
  } else {
    EXPECT_FALSE(poses->at(1).reason.empty());
  }
}

TEST_F(RegistrationInput, PinsWithWrongLabels) {
  const std::string tablet = at("tablet").string();
  const std::string scans = at("scans").string();
  ASSERT_EQ(test::run_command({"simulate", "tablet", "--seed", "3", "--size", "26x22x12", "--spacing", "0.15",
                               "-o", tablet})
                .status,
            0);
  ASSERT_EQ(test::run_command({"simulate", "scans", "--tablet", tablet + "/tablet.ply", "--views", "4",
                               "--spacing", "0.12", "--seed", "3", "--pins", "-o", scans})
                .status,
            0);
  const auto truth = read_poses(at("scans") / "truth_poses.json");
  auto pins = read_pins(at("scans") / "pins.json");
  ASSERT_TRUE(truth && pins);
  for (auto& [id, tips] : pins->tips) {  // every label on another pin, a different one in every scan
    const int first = tips.front().label;
    for (std::size_t t = 0; t + 1 < tips.size() && id > 0; ++t) {
      tips[t].label = tips[t + 1].label;
    }
    tips.back().label = id > 0 ? first : tips.back().label;
  }
  ASSERT_TRUE(write_pins(at("wrong.json"), *pins));
  const Outcome outcome =
      test::run_command({"register", scans, "--pins", at("wrong.json").string(), "--json"});
  const auto poses = parse_poses(outcome.out, "answer");
  ASSERT_TRUE(poses) << outcome.out << outcome.err;
  ASSERT_EQ(poses->size(), truth->size());
  for (std::size_t k = 1; k < poses->size(); ++k) {
    const ScanPose& pose = poses->at(k);
    if (pose.status != PoseStatus::kRegistered || poses->front().status != PoseStatus::kRegistered) {
      EXPECT_EQ(pose.reason.empty(), pose.status == PoseStatus::kRegistered);
      continue;
    }
    const RigidTransform found = poses->front().model_from_scanner.inverse() * pose.model_from_scanner;
    const RigidTransform right =
        truth->front().model_from_scanner.inverse() * truth->at(k).model_from_scanner;
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(13, 0, 0), Eigen::Vector3d(0, 11, 6)}) {
      EXPECT_LT((found * p - right * p).norm(), 0.15) << k;
    }
  }
}

}  // namespace
}  // namespace dubsar
